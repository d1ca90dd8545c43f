#include "suite/nn/pooled_cnn.h"

#include <functional>
#include <memory>
#include <utility>

#include "suite/core/check.h"
#include "suite/core/option_check.h"
#include "suite/nn/activation.h"
#include "suite/nn/conv.h"
#include "suite/nn/linear.h"
#include "suite/nn/rearrange.h"
#include "suite/nn/resample.h"
#include "suite/nn/sequential.h"

namespace physinv::nn {
namespace {

template <class T>
class Builder {
 public:
  explicit Builder(const PooledCnnOptions& options)
      : o_(options), grid_{options.positions} {}

  void block(Index width) {
    if (o_.pool_first) pool();
    convolve(width);
    convolve(width);
    if (!o_.pool_first) pool();
  }
  void flatten() {
    add(nn::flatten<T>(grid_.positions(), channels_));
    channels_ *= grid_.positions();
  }
  void dense(Index width, Activation activation) {
    add(linear<T>(channels_, width));
    if (activation != Activation::identity)
      add(activation_layer<T>(activation, width));
    channels_ = width;
  }
  std::unique_ptr<Network<T>> network() {
    return sequential<T>(std::move(layers_), o_.init);
  }

 private:
  void add(LayerPointer<T> layer) { layers_.push_back(std::move(layer)); }
  void pool() {
    add(max_pool<T>(grid_, channels_));
    grid_ = halved(grid_);
  }
  void convolve(Index width) {
    const ConvOptions options{.grid = grid_,
                              .in = channels_,
                              .out = width,
                              .taps = {3, 1},
                              .padding = o_.padding,
                              .batch_statistics = o_.batch_norm};
    channels_ = width;
    if (o_.batch_norm) {
      add(conv_block<T>(options, Activation::relu, false));
    } else {
      add(conv<T>(options));
      add(activation_layer<T>(Activation::relu, grid_.positions() * width));
    }
  }

  const PooledCnnOptions& o_;
  Grid grid_;
  Index channels_ = 1;
  Layers<T> layers_;
};

template <class T>
std::unique_ptr<Network<T>> make(const PooledCnnOptions& o,
                                 Index inputs,
                                 Index outputs) {
  SUITE_CHECK(o.positions > 0, "the input must have positions");
  SUITE_CHECK(all_positive(o.features) && all_positive(o.hidden),
              "blocks and hidden layers must have at least 1 feature");
  SUITE_CHECK(inputs == o.positions,
              "the network's grid does not match its input");
  Builder<T> net(o);
  for (const Index width : o.features) net.block(width);
  net.flatten();
  for (const Index width : o.hidden) net.dense(width, Activation::relu);
  net.dense(outputs, o.output);
  return net.network();
}

}  // namespace

NetworkRecipe pooled_cnn(const PooledCnnOptions& options) {
  return {.description = "pooled_cnn " + in_line(describe(options)),
          .make_float = std::bind_front(make<float>, options),
          .make_double = std::bind_front(make<double>, options)};
}

}  // namespace physinv::nn
