#include "suite/nn/cnn.h"

#include <functional>
#include <memory>
#include <utility>

#include "suite/core/check.h"
#include "suite/core/option_check.h"
#include "suite/nn/activation.h"
#include "suite/nn/conv.h"
#include "suite/nn/linear.h"
#include "suite/nn/sequential.h"

namespace physinv::nn {
namespace {

template <class T>
std::unique_ptr<Network<T>> make(const CnnOptions& o,
                                 Index inputs,
                                 Index outputs) {
  SUITE_CHECK(o.positions > 0 && o.channels > 0,
              "the input must have positions and channels");
  SUITE_CHECK(all_positive(o.features),
              "a convolution must have at least 1 feature");
  SUITE_CHECK(o.taps > 0, "a convolution must have at least 1 tap");
  SUITE_CHECK(inputs == o.positions * o.channels,
              "the network's grid does not match its input");
  Layers<T> layers;
  Index positions = o.positions, channels = o.channels;
  for (const Index width : o.features) {
    layers.push_back(conv<T>({.grid = {positions},
                              .in = channels,
                              .out = width,
                              .taps = {o.taps, 1},
                              .padding = Padding::none}));
    positions -= o.taps - 1, channels = width;
    layers.push_back(activation_layer<T>(o.activation, positions * channels));
  }
  layers.push_back(linear<T>(positions * channels, outputs));
  return sequential<T>(std::move(layers), o.init);
}

}  // namespace

NetworkRecipe cnn(const CnnOptions& options) {
  return {.description = "cnn " + in_line(describe(options)),
          .make_float = std::bind_front(make<float>, options),
          .make_double = std::bind_front(make<double>, options)};
}

}  // namespace physinv::nn
