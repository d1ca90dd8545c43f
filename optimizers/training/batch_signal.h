/// Signals of minibatches that push the estimates: the network's outputs become
/// estimates x, what pushes x goes back through the map and the network. A
/// signal of this kind says no more than `push`.
#pragma once

#include <memory>
#include <vector>

#include "optimizers/training/batches.h"
#include "optimizers/training/output_map.h"
#include "optimizers/training/signal.h"
#include "optimizers/training/signal_recipe.h"

namespace physinv {

/// Leaves `batch_loss` (1 x updates): mean before the update. With a LateError
/// `late_error` (1): mean over the last updates' batches.
template <class T>
class BatchSignal : public Signal<T> {
 public:
  explicit BatchSignal(const SignalPlace<T>& place);

  Vector<T>& gradient() override;
  /// As of a solver that hands the estimates on.
  Jacobians<T> jacobians() override;
  void hessian_product(const Vector<T>& direction, Vector<T>& product) override;
  void gauss_newton_product(const Vector<T>& direction,
                            Vector<T>& product) override;
  double objective() override;
  void serialize(Archive& archive) override {
    archive(losses_, late_, late_samples_);
  }
  void export_to(Outcome& out) const override;
  std::size_t bytes() const override;

 protected:
  /// x_bar = factor * d objective / d x and the losses of samples `first`,
  /// first+1 .. of the batch, for as many as x has columns.
  virtual void push(BatchIn<T> x,
                    Index first,
                    VectorOut<double> loss,
                    BatchOut<T> x_bar) = 0;

  /// For products: the derivative of the last `push`, of the whole batch, where
  /// x moves along x_dot; without second derivatives of the solver if `linear`.
  virtual void push_tangent(BatchIn<T> x_dot,
                            bool linear,
                            BatchOut<T> x_bar_dot);
  /// Losses alone, of the whole batch.
  virtual void weigh(BatchIn<T> x, VectorOut<double> loss);

  /// Estimates for samples first .. first+count-1, in training mode.
  const Batch<T>& estimate(Index first, Index count);
  void note_loss() { losses_.push_back(loss_.mean()); }

  StageRun& run_;
  NetworkModel<T>& model_;
  Batches<T>& batches_;
  SignalOptions options_;
  T factor_;
  std::unique_ptr<OutputMap<T>> map_;
  Vector<double> loss_;

 private:
  Vector<T>& gradient_of(Index first, Index count);
  void note_late(Index first, Index count);
  /// x_bar_dot_ becomes a derivative by the outputs.
  const Batch<T>& moved(const Vector<T>& direction, bool linear);

  Batch<T> x_, x_bar_, x_dot_, x_bar_dot_, identity_;
  Vector<T> sum_;
  std::vector<double> losses_;
  double late_ = 0;
  Index late_samples_ = 0;
};

extern template class BatchSignal<float>;
extern template class BatchSignal<double>;

}  // namespace physinv
