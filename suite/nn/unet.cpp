#include "suite/nn/unet.h"

#include <fmt/format.h>

#include <functional>
#include <memory>
#include <utility>

#include "suite/core/check.h"
#include "suite/nn/conv.h"
#include "suite/nn/rearrange.h"
#include "suite/nn/resample.h"
#include "suite/nn/sequential.h"
#include "suite/nn/skip.h"

namespace physinv::nn {
namespace {

template <class T>
using Layers = typename Sequential<T>::Layers;

/// D(in -> out)
template <class T>
void add_double(Layers<T>& to, Grid grid, Index in, Index out) {
  for (const Index from : {in, out})
    to.push_back(std::make_unique<ConvBlock<T>>(
        ConvOptions{.grid = grid,
                    .in = from,
                    .out = out,
                    .taps = {3, grid.flat() ? 1 : 3}},
        Activation::relu,
        false));
}

/// D(in -> f), and below it the coarser levels around a skip connection.
template <class T>
void add_level(Layers<T>& to, Grid grid, Index in, Index f, Index levels) {
  add_double<T>(to, grid, in, f);
  if (levels == 1) return;
  Layers<T> inner;
  inner.push_back(std::make_unique<MaxPool<T>>(grid, f));
  add_level<T>(inner, halved(grid), f, f, levels - 1);
  inner.push_back(std::make_unique<Upsample<T>>(halved(grid), f));
  to.push_back(std::make_unique<Skip<T>>(grid.positions(), std::move(inner)));
  add_double<T>(to, grid, 2 * f, f);
}

template <class T>
std::unique_ptr<Network<T>> make(const UnetOptions& o,
                                 Index inputs,
                                 Index outputs) {
  const Index positions = o.grid.positions();
  const FieldInputOptions input{.positions = positions,
                                .before = o.scalars_before,
                                .channels = o.channels,
                                .after = o.scalars_after,
                                .shift = o.scalar_shift,
                                .unit = o.scalar_unit};
  SUITE_CHECK(inputs == input.inputs() && outputs == o.outputs * positions,
              "the network's grid is not that of its input and output");
  SUITE_CHECK(o.levels >= 1, "a u-net has at least one level");
  Layers<T> layers;
  if (input.width() > 1)
    layers.push_back(std::make_unique<FieldInput<T>>(input));
  add_level<T>(layers, o.grid, input.width(), o.features, o.levels);
  layers.push_back(std::make_unique<Conv<T>>(ConvOptions{
      .grid = o.grid, .in = o.features, .out = o.outputs, .taps = {1, 1}}));
  if (o.outputs > 1)
    layers.push_back(std::make_unique<Flatten<T>>(positions, o.outputs));
  return std::make_unique<Sequential<T>>(std::move(layers));
}

}  // namespace

NetworkRecipe unet(const UnetOptions& options) {
  return {.description = fmt::format(
              "unet grid={}x{} scalars={}+{} shift={} unit={} channels={} "
              "levels={} features={} outputs={}",
              options.grid.columns,
              options.grid.rows,
              options.scalars_before,
              options.scalars_after,
              options.scalar_shift,
              options.scalar_unit,
              options.channels,
              options.levels,
              options.features,
              options.outputs),
          .make_float = std::bind_front(make<float>, options),
          .make_double = std::bind_front(make<double>, options)};
}

}  // namespace physinv::nn
