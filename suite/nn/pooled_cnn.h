/// Convolutional network from a signal to a few numbers (S2S): per entry of
/// `features` a block of
///
///   max pooling by 2 - conv - ReLU - conv - ReLU
///
/// with 3 taps and zero padding, or with the pooling behind the convolutions;
/// flatten as [channel][position]; per entry of `hidden` Linear - ReLU; a final
/// Linear with `output` behind it. `batch_norm` normalises behind every
/// convolution, by the batch's statistics in every pass.
///
///   nn::pooled_cnn({.positions = 256, .features = {16, 16, 16, 16, 16},
///                   .hidden = {64, 32}, .output = Activation::half_tanh})
///
/// has 17,489 parameters for one output, 17,809 with batch normalisation.
/// (Scale-invariant physics training, App. C.1.)
#pragma once

#include <vector>

#include "suite/core/network.h"
#include "suite/nn/grid.h"
#include "suite/nn/kinds.h"

namespace physinv::nn {

struct PooledCnnOptions {
  Index positions = 1;          ///< of the input, one channel
  std::vector<Index> features;  ///< channels of both convolutions of a block
  std::vector<Index> hidden;    ///< widths of the dense layers
  Activation output = Activation::identity;
  Padding padding = Padding::zero;
  bool batch_norm = false;
  bool pool_first = true;
  Init init = Init::glorot;

  auto fields() const {
    return std::tuple{field("positions", positions),
                      word("features", text_of(features, "-"), features),
                      word("hidden", text_of(hidden, "-"), hidden),
                      field("output", output),
                      field("padding", padding),
                      field("batch_norm", batch_norm),
                      field("pool_first", pool_first),
                      if_changed(field("init", init))};
  }
};

NetworkRecipe pooled_cnn(const PooledCnnOptions& options);

}  // namespace physinv::nn
