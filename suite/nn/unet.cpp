#include "suite/nn/unet.h"

#include <functional>
#include <memory>
#include <utility>

#include "suite/core/check.h"
#include "suite/core/option_check.h"
#include "suite/nn/conv.h"
#include "suite/nn/rearrange.h"
#include "suite/nn/resample.h"
#include "suite/nn/sequential.h"
#include "suite/nn/skip.h"

namespace physinv::nn {
namespace {

/// D(in -> f)
template <class T>
void add_double(Layers<T>& to, const UnetOptions& o, Grid grid, Index in) {
  for (const Index from : {in, o.features})
    to.push_back(conv_block<T>({.grid = grid,
                                .in = from,
                                .out = o.features,
                                .taps = {3, grid.flat() ? 1 : 3},
                                .padding = o.padding,
                                .batch_statistics = o.batch_statistics},
                               Activation::relu,
                               false));
}

/// D(in -> f), and below it the coarser levels around a skip connection.
template <class T>
void add_level(
    Layers<T>& to, const UnetOptions& o, Grid grid, Index in, Index levels) {
  const Index f = o.features;
  add_double<T>(to, o, grid, in);
  if (levels == 1) return;
  SUITE_CHECK(grid.flat() == halved(grid).flat(),
              "a u-net's coarsest grid must have at least two rows");
  Layers<T> inner;
  inner.push_back(max_pool<T>(grid, f));
  add_level<T>(inner, o, halved(grid), f, levels - 1);
  inner.push_back(upsample<T>(halved(grid), grid, f));
  to.push_back(skip<T>(grid.positions(), std::move(inner)));
  add_double<T>(to, o, grid, 2 * f);
}

template <class T>
std::unique_ptr<Network<T>> make_unet(const UnetOptions& o,
                                      Index inputs,
                                      Index outputs) {
  SUITE_CHECK(o.grid.columns > 0 && o.grid.rows > 0,
              "a grid must have at least one position");
  SUITE_CHECK(o.channels > 0 && o.features > 0 && o.outputs > 0,
              "channels, features and outputs must be at least 1");
  SUITE_CHECK(o.scalars_before >= 0 && o.scalars_after >= 0,
              "numbers of scalars must not be negative");
  SUITE_CHECK(o.hidden >= 0 && o.hidden < o.grid.columns,
              "hidden must be at least 0 and less than the number of columns");
  check_numbers<T>(
      {{"scalar_shift", o.scalar_shift}, {"scalar_unit", o.scalar_unit}});
  SUITE_CHECK(o.scalar_unit != 0, "scalar_unit must not be 0");
  const Index positions = o.grid.positions();
  const FieldInputOptions input{.positions = positions,
                                .before = o.scalars_before,
                                .channels = o.channels,
                                .after = o.scalars_after,
                                .shift = o.scalar_shift,
                                .unit = o.scalar_unit,
                                .columns = o.grid.columns,
                                .hidden = o.hidden};
  SUITE_CHECK(inputs == input.inputs() &&
                  outputs == o.outputs * (positions - o.hidden * o.grid.rows),
              "the network's grid does not match its input and output");
  SUITE_CHECK(o.hidden == 0 || o.outputs > 1,
              "hidden columns need a u-net with two outputs or more");
  SUITE_CHECK(o.levels >= 1, "a u-net must have at least one level");
  Layers<T> layers;
  if (input.width() > 1 || o.hidden > 0)
    layers.push_back(field_input<T>(input));
  add_level<T>(layers, o, o.grid, input.width(), o.levels);
  layers.push_back(conv<T>(
      {.grid = o.grid, .in = o.features, .out = o.outputs, .taps = {1, 1}}));
  if (o.outputs > 1)
    layers.push_back(
        flatten<T>(positions, o.outputs, o.grid.columns, o.hidden));
  return sequential<T>(std::move(layers), o.init);
}

}  // namespace

NetworkRecipe unet(const UnetOptions& options) {
  return {.description = "unet " + in_line(describe(options)),
          .make_float = std::bind_front(make_unet<float>, options),
          .make_double = std::bind_front(make_unet<double>, options)};
}

}  // namespace physinv::nn
