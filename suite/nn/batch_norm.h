/// Batch normalisation of dense features (Ioffe and Szegedy 2015):
/// y = scale (x - mean) / sqrt(variance + 1e-5) + offset.
///
/// Training passes use the batch's mean and biased variance and need at least
/// two samples; other passes use the running ones. `update_state` moves the
/// running mean and (unbiased) variance a tenth of the way to the batch's.
/// Parameters: scale, offset. State: running mean, running variance.
#pragma once

#include <vector>

#include "suite/nn/layer.h"

namespace physinv::nn {

template <class T>
class BatchNorm final : public Layer<T> {
 public:
  explicit BatchNorm(Index features) : Layer<T>(features, features) {}

  std::vector<TensorInfo> tensors() const override;
  Index state_count() const override { return 2 * this->inputs(); }
  void initialize_state(T* state) const override;
  std::size_t slots() const override { return 1; }
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
  double operations() const override {
    return 8.0 * static_cast<double>(this->inputs());
  }
};

extern template class BatchNorm<float>;
extern template class BatchNorm<double>;

}  // namespace physinv::nn
