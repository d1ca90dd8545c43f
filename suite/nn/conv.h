/// Convolutional layers on rows laid out position by position (see window.h).
#pragma once

#include "suite/nn/channel_norm.h"
#include "suite/nn/convolution.h"
#include "suite/nn/layer.h"

namespace physinv::nn {

struct ConvOptions {
  Grid grid;
  Index in = 1, out = 1;  ///< channels
  Taps taps;              ///< {3, 1}; {3, 3} on a plane
  Padding padding = Padding::zero;
  /// A block's normalisation: the batch's statistics in every pass, running
  /// ones in none.
  bool batch_statistics = false;
};

/// y = f(W * x + b), f an activation taken in (see `fuse`).
/// Parameters: W [out][in][tap], b.
template <class T>
LayerPointer<T> conv(const ConvOptions& options);

/// Convolution - batch normalisation over samples and positions - activation
/// (- max pooling by 2) in two passes over memory: statistics are taken of rows
/// just computed, the rest is one pass more. The reverse is two passes as well.
///
/// Parameters: W [out][in][tap], b, scale, offset. State: running means and
/// (unbiased) variances. In training b has no effect; its gradient is zero.
/// The activation must not decrease where it is pooled, and its derivative
/// must follow from its output.
template <class T>
LayerPointer<T> conv_block(const ConvOptions& options,
                           Activation activation,
                           bool pool);

}  // namespace physinv::nn
