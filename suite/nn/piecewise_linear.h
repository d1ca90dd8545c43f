/// Layers without parameters that are linear in their input, or linear in
/// pieces: forward mode is the forward pass, and the reverse acts on a
/// cotangent's derivative as on the cotangent.
#pragma once

#include "suite/nn/layer.h"

namespace physinv::nn {

template <class T>
class PiecewiseLinear : public Layer<T> {
 public:
  using Layer<T>::Layer;

  void tangent(const LayerArgs<T>& at, const Tangent<T>& t) const override {
    this->forward(at, t.x_dot, t.y_dot);
  }
  void backward_tangent(const LayerArgs<T>& at,
                        const BackwardTangent<T>& b) const override {
    Backward<T> step = b.base();
    this->backward(at, step);
    step.y_bar = b.y_bar_dot, step.x_bar = b.x_bar_dot;
    this->backward(at, step);
  }
};

}  // namespace physinv::nn
