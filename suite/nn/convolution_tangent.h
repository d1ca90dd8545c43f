/// A convolution is bilinear in weights and input: the derivative of each of
/// its three products is the sum of two.
#pragma once

#include "suite/nn/convolution.h"

namespace physinv::nn {

/// y_dot of x_dot and at.parameters_dot, with `done` as in `forward`.
template <class T, class F>
void push_convolution(const Convolution<T>& conv,
                      const LayerArgs<T>& at,
                      Lanes<const T> x,
                      Lanes<const T> x_dot,
                      Lanes<T> y_dot,
                      F&& done) {
  conv.forward(at,
               {{at.parameters_dot, x}, {at.parameters, x_dot}},
               at.parameters_dot + conv.shape().weights(),
               y_dot,
               done);
}

/// The gradients by weights and x, and their derivatives, for these cotangents
/// (those of `b` may lie behind something else). b.parameters_bar may be null,
/// so may the pair b.x_bar, b.x_bar_dot.
template <class T>
void pull_convolution(const Convolution<T>& conv,
                      const LayerArgs<T>& at,
                      const BackwardTangent<T>& b,
                      Lanes<const T> y_bar,
                      Lanes<const T> y_bar_dot);

}  // namespace physinv::nn
