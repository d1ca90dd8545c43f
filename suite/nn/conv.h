/// Convolutional layers on rows laid out position by position (see window.h).
#pragma once

#include <vector>

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
class Conv final : public Layer<T> {
 public:
  explicit Conv(const ConvOptions& options);

  std::vector<TensorInfo> tensors() const override;
  bool fuse(Activation a) override;
  Activation fused() const override { return activation_; }
  void forward(const LayerArgs<T>& at,
               Lanes<const T> x,
               Lanes<T> y) const override;
  void backward(const LayerArgs<T>& at, const Backward<T>& b) const override;
  void tangent(const LayerArgs<T>& at, const Tangent<T>& t) const override;
  void backward_tangent(const LayerArgs<T>& at,
                        const BackwardTangent<T>& b) const override;
  /// Without padding only: the patches then lie in x as they are.
  void add_rows(Lanes<const T> x,
                Lanes<const T> y_bar,
                Index offset,
                std::vector<LayerRows<T>>& layers) const override;
  bool evaluate_plainly(const double* parameters,
                        const Vector<double>& x,
                        Vector<double>& y) const override;
  double operations() const override { return conv_.operations(); }

 private:
  Convolution<T> conv_;
  Padding padding_;
  Activation activation_ = Activation::identity;
};

/// Convolution - batch normalisation over samples and positions - activation
/// (- max pooling by 2) in two passes over memory: statistics are taken of rows
/// just computed, the rest is one pass more. The reverse is two passes as well.
///
/// Parameters: W [out][in][tap], b, scale, offset. State: running means and
/// (unbiased) variances. In training b has no effect; its gradient is zero.
/// The activation must not decrease where it is pooled, and its derivative
/// must follow from its output.
template <class T>
class ConvBlock final : public Layer<T> {
 public:
  ConvBlock(const ConvOptions& options, Activation activation, bool pool);

  std::vector<TensorInfo> tensors() const override;
  Index state_count() const override {
    return batch_statistics_ ? 0 : 2 * norm_.channels;
  }
  void initialize_state(T* state) const override;
  std::size_t slots() const override { return 2; }
  void forward(const LayerArgs<T>& at,
               Lanes<const T> x,
               Lanes<T> y) const override;
  void backward(const LayerArgs<T>& at, const Backward<T>& b) const override;
  void tangent(const LayerArgs<T>& at, const Tangent<T>& t) const override;
  void backward_tangent(const LayerArgs<T>& at,
                        const BackwardTangent<T>& b) const override;
  void update_state(const Tape& tape,
                    std::size_t slot,
                    T* state) const override;
  double operations() const override { return conv_.operations(); }

 private:
  /// Means over samples and positions that the cotangent of a normalisation
  /// needs (2 x channels).
  const T* pulled_means(const LayerArgs<T>& at,
                        const Backward<T>& b,
                        const NormColumns<T>& kept,
                        Lanes<const T> z) const;
  bool by_batch(const LayerArgs<T>& at) const {
    return at.training || batch_statistics_;
  }

  Convolution<T> conv_;
  NormShape norm_;
  bool batch_statistics_;
};

extern template class Conv<float>;
extern template class Conv<double>;
extern template class ConvBlock<float>;
extern template class ConvBlock<double>;

}  // namespace physinv::nn
