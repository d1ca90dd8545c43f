/// Skip connection: y = (x, inner(x)) along the channels, on rows laid out
/// position by position (see window.h). `inner` keeps the grid.
#pragma once

#include <memory>
#include <vector>

#include "suite/nn/layer.h"

namespace physinv::nn {

template <class T>
class Skip final : public Layer<T> {
 public:
  using Layers = std::vector<std::unique_ptr<Layer<T>>>;

  /// inner: layers one after the other, at least one. Their activations stay
  /// their own.
  Skip(Index positions, Layers inner);

  std::vector<TensorInfo> tensors() const override;
  Index state_count() const override { return state_count_; }
  void initialize_state(T* state) const override;
  std::size_t slots() const override { return slots_; }
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
  double operations() const override;

 private:
  /// Where an inner layer's numbers are, relative to this layer's.
  struct Place {
    Index parameters = 0, state = 0;
    std::size_t slot = 0;
  };
  /// Output of inner layer i, or its derivative.
  Lanes<T> kept(const Tape& tape,
                std::size_t slot,
                std::size_t i,
                Index samples) const;
  LayerArgs<T> args(const LayerArgs<T>& at, std::size_t i) const;

  Index positions_;
  Layers inner_;
  std::vector<Place> places_;
  Index state_count_ = 0, widest_ = 0;
  std::size_t slots_ = 0;
};

extern template class Skip<float>;
extern template class Skip<double>;

}  // namespace physinv::nn
