/// y = f(W x + b), f an activation taken in (see `fuse`).
///
/// Parameters: W [out][in] row-major, then b. Input rows that are constant
/// over the batch (`LayerArgs::leading`, `trailing`) become one vector: the
/// bias is b + W_const x_const, and their weight gradient is
/// (sum over samples of y_bar) x_const^T. Only rounding differs.
#pragma once

#include <vector>

#include "suite/nn/layer.h"

namespace physinv::nn {

template <class T>
class Linear final : public Layer<T> {
 public:
  Linear(Index inputs, Index outputs) : Layer<T>(inputs, outputs) {}

  std::vector<TensorInfo> tensors() const override;
  bool fuse(Activation a) override;
  bool folds_constants() const override { return true; }
  Activation fused() const override { return activation_; }
  void forward(const LayerArgs<T>& at,
               Lanes<const T> x,
               Lanes<T> y) const override;
  void backward(const LayerArgs<T>& at, const Backward<T>& b) const override;
  void tangent(const LayerArgs<T>& at, const Tangent<T>& t) const override;
  void backward_tangent(const LayerArgs<T>& at,
                        const BackwardTangent<T>& b) const override;
  void add_rows(Lanes<const T> x,
                Lanes<const T> y_bar,
                Index offset,
                std::vector<LayerRows<T>>& layers) const override;
  bool evaluate_plainly(const double* parameters,
                        const Vector<double>& x,
                        Vector<double>& y) const override;
  double operations() const override;

 private:
  void weight_gradient(const LayerArgs<T>& at, const Backward<T>& b) const;

  Activation activation_ = Activation::identity;
};

extern template class Linear<float>;
extern template class Linear<double>;

}  // namespace physinv::nn
