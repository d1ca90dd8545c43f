#include "suite/nn/vgg.h"

#include <functional>
#include <memory>
#include <utility>

#include "suite/core/check.h"
#include "suite/core/option_check.h"
#include "suite/nn/activation.h"
#include "suite/nn/batch_norm.h"
#include "suite/nn/conv.h"
#include "suite/nn/linear.h"
#include "suite/nn/rearrange.h"
#include "suite/nn/sequential.h"

namespace physinv::nn {
namespace {

template <class T>
std::unique_ptr<Network<T>> make_vgg(const VggOptions& o,
                                     Index inputs,
                                     Index outputs) {
  Layers<T> layers;
  const auto add = [&](auto layer) { layers.push_back(std::move(layer)); };
  Grid grid = o.grid;
  Index channels = o.channels;
  SUITE_CHECK(channels > 0 && grid.columns > 0 && grid.rows > 0,
              "the input must have channels and positions");
  SUITE_CHECK(all_positive(o.features) && all_positive(o.hidden),
              "blocks and hidden layers must have at least 1 feature");
  SUITE_CHECK(inputs == channels * grid.positions(),
              "the network's grid does not match its input");
  if (channels > 1)
    add(field_input<T>({.positions = grid.positions(), .channels = channels}));
  for (const Index width : o.features) {
    add(conv_block<T>({.grid = grid,
                       .in = channels,
                       .out = width,
                       .taps = {3, grid.flat() ? 1 : 3}},
                      Activation::relu,
                      true));
    grid = halved(grid);
    channels = width;
  }
  add(flatten<T>(grid.positions(), channels));
  Index size = grid.positions() * channels;
  for (const Index width : o.hidden) {
    add(linear<T>(size, width));
    add(activation_layer<T>(Activation::relu, width));
    add(batch_norm<T>(width));
    size = width;
  }
  add(linear<T>(size, outputs));
  return sequential<T>(std::move(layers));
}

}  // namespace

NetworkRecipe vgg(const VggOptions& options) {
  return {.description = "vgg " + in_line(describe(options)),
          .make_float = std::bind_front(make_vgg<float>, options),
          .make_double = std::bind_front(make_vgg<double>, options)};
}

}  // namespace physinv::nn
