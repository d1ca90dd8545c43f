/// Forward mode of a convolution with its normalisation (ConvBlock), and its
/// reverse.
#pragma once

#include "suite/nn/channel_norm.h"
#include "suite/nn/convolution.h"

namespace physinv::nn {

template <class T>
struct BlockParts {
  const Convolution<T>& conv;
  const NormShape& norm;
  bool by_batch;  ///< statistics; else constant ones
};

/// Slots as the block's own: z_dot, then NormDots.
template <class T>
void push_block(const BlockParts<T>& block,
                const Replay<T>& at,
                const Tangent<T>& t);

template <class T>
void pull_block(const BlockParts<T>& block,
                const Replay<T>& at,
                const BackwardTangent<T>& b);

}  // namespace physinv::nn
