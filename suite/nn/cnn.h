/// One-dimensional convolutional network: convolutions without padding, stride
/// 1, then one dense layer.
///
///   nn::cnn({.positions = 14, .channels = 2, .features = {20, 20, 20, 20, 20,
///            20}})
///
/// shortens 14 positions to 2 and has 21,984 parameters for 384 outputs.
/// (Half-inverse gradients, App. B.4.)
#pragma once

#include <vector>

#include "suite/core/network.h"
#include "suite/core/options.h"
#include "suite/nn/kinds.h"

namespace physinv::nn {

struct CnnOptions {
  Index positions = 1,
        channels = 1;           ///< of the input, rows [position][channel]
  std::vector<Index> features;  ///< channels after each convolution
  Index taps = 3;
  Activation activation = Activation::tanh;  ///< behind each convolution
  Init init = Init::glorot;

  auto fields() const {
    return std::tuple{field("positions", positions),
                      field("channels", channels),
                      word("features", text_of(features, "-"), features),
                      field("taps", taps),
                      field("activation", activation),
                      if_changed(field("init", init))};
  }
};

NetworkRecipe cnn(const CnnOptions& options);

}  // namespace physinv::nn
