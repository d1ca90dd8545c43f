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

  void tangent(const Replay<T>& at, const Tangent<T>& t) const override {
    this->forward({at, *t.dots, nullptr}, t.x_dot, t.y_dot);
  }
  void backward_tangent(const Replay<T>& at,
                        const BackwardTangent<T>& b) const override {
    this->backward(at, b.base());
    this->backward(at, b.base_dot());
  }
};

}  // namespace physinv::nn
