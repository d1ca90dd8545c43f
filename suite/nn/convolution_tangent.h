/// A convolution is bilinear in weights and input: the derivative of each of
/// its three products is the sum of two.
#pragma once

#include "suite/nn/convolution.h"

namespace physinv::nn {

/// y_dot of t.x_dot and t.parameters_dot, with `done` as in `forward`.
template <class T, class F>
void push_convolution(const Convolution<T>& conv,
                      const Replay<T>& at,
                      const Tangent<T>& t,
                      Rows<T> y_dot,
                      F&& done) {
  conv.forward(at,
               {{t.parameters_dot, t.x}, {at.parameters, t.x_dot}},
               t.parameters_dot + conv.shape().weights(),
               y_dot,
               done);
}

/// The gradients by weights and x, and their derivatives, for these cotangents
/// (those of `b` may lie behind something else). b.parameters_bar may be null,
/// so may the pair b.x_bar, b.x_bar_dot.
template <class T>
void pull_convolution(const Convolution<T>& conv,
                      const Replay<T>& at,
                      const BackwardTangent<T>& b,
                      Rows<const T> y_bar,
                      Rows<const T> y_bar_dot);

}  // namespace physinv::nn
