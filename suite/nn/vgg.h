/// VGG-like classifier (G2S): from a grid to a few numbers.
///
/// Per entry of `features` a block convolution (3 taps per axis, zero padding)
/// - batch normalisation - ReLU - max pooling by 2; flatten as
/// [channel][position]; per entry of `hidden` Linear - ReLU - batch
/// normalisation; a final Linear. (Joint parameter optimization, App. C.)
#pragma once

#include <vector>

#include "suite/core/network.h"
#include "suite/nn/grid.h"

namespace physinv::nn {

struct VggOptions {
  Index channels = 1;           ///< of the input, rows [channel][position]
  Grid grid;                    ///< extent divisible by 2^blocks
  std::vector<Index> features;  ///< channels after each block
  std::vector<Index> hidden;    ///< widths of the dense layers

  auto fields() const {
    return std::tuple{field("channels", channels),
                      word("grid", grid.text(), grid),
                      word("features", text_of(features, "-"), features),
                      word("hidden", text_of(hidden, "-"), hidden)};
  }
};

NetworkRecipe vgg(const VggOptions& options);

}  // namespace physinv::nn
