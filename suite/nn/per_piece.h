/// The same layers on every piece of a field, a piece being some positions
/// that follow each other: for layers that look at one position at a time and
/// are much wider inside than at their ends. What runs between them stays in
/// the cache, and is made again in `backward` instead of being kept.
#pragma once

#include <memory>
#include <vector>

#include "suite/nn/layer.h"

namespace physinv::nn {

template <class T>
class PerPiece final : public Layer<T> {
 public:
  using Layers = std::vector<std::unique_ptr<Layer<T>>>;

  /// inner: layers one after the other, at least one, on one piece, without
  /// state or tape slots. Their activations stay their own.
  PerPiece(Index pieces, Layers inner);

  std::vector<TensorInfo> tensors() const override;
  void forward(const LayerArgs<T>& at,
               Lanes<const T> x,
               Lanes<T> y) const override;
  void backward(const LayerArgs<T>& at, const Backward<T>& b) const override;
  void tangent(const LayerArgs<T>& at, const Tangent<T>& t) const override;
  void backward_tangent(const LayerArgs<T>& at,
                        const BackwardTangent<T>& b) const override;
  double operations() const override;

 private:
  LayerArgs<T> args(const LayerArgs<T>& at,
                    std::size_t i,
                    Workspace& work) const;
  /// Outputs of all layers for one piece; without y, of all but the last.
  std::vector<Lanes<T>> run(const LayerArgs<T>& at,
                            Lanes<const T> x,
                            Lanes<T> y,
                            Workspace& work) const;
  void pull(const LayerArgs<T>& at,
            const Backward<T>& b,
            Workspace& work) const;
  /// Derivatives of all layers' outputs, the last one's in t.y_dot; without
  /// it, of all but the last. `outputs` are those of `run`.
  std::vector<Lanes<T>> push(const LayerArgs<T>& at,
                             const std::vector<Lanes<T>>& outputs,
                             Tangent<T> t,
                             Workspace& work) const;
  void pull_tangent(const LayerArgs<T>& at,
                    const BackwardTangent<T>& b,
                    Workspace& work) const;
  /// step(piece, bars, workspace) for every piece; bars, one after the other,
  /// are what it leaves in its array of the same size, summed.
  template <class F>
  void sum_pieces(Workspace& work, Index size, T* bars, F&& step) const;

  Index pieces_;
  Layers inner_;
  std::vector<Index> parameters_;  ///< first of each inner layer's
  Index parameter_count_ = 0, widest_ = 0;
};

extern template class PerPiece<float>;
extern template class PerPiece<double>;

}  // namespace physinv::nn
