/// Minibatches of training problems with their physics. Nothing allocates
/// after the first batch, unless every batch is drawn afresh.
#pragma once

#include <memory>

#include "suite/core/method.h"

namespace physinv {

template <class T>
class Minibatch {
 public:
  /// Slices of `batch` problems out of as many as the case has (`batch` is cut
  /// to that number, a remainder is left out); with `fresh`, new problems from
  /// number `drawn` on for every batch.
  Minibatch(StageRun& run, Index batch, bool fresh, Index drawn);

  void next();

  Index size() const { return batch_; }
  /// Problems used so far, those of earlier stages included.
  Index drawn() const { return drawn_; }
  /// What the network reads.
  auto input() const { return input_.middleCols(first_, batch_); }

  /// y = F(x), losses, y_bar = factor * d loss / d y, and x_bar = J^T y_bar.
  /// x may be a part of the batch, from sample `first` on.
  void gradient(BatchIn<T> x, T factor, BatchOut<T> x_bar, Index first = 0);
  /// The same with the solver's Jacobians (see suite/core/problem.h) in place
  /// of x_bar; y_bar is projected if wanted and the problem can.
  void jacobian(BatchIn<T> x, T factor, bool project, BatchOut<T> j);

  const Batch<T>& y_bar() const { return y_bar_; }
  double mean_loss() const { return loss_.mean(); }

  Counts counts() const;
  std::size_t bytes() const;

 private:
  void load(const Samples<double>& from);
  /// Losses at y, and y_bar.
  void weigh(T factor, Index first, Index count);

  StageRun& run_;
  std::unique_ptr<Problem<T>> problem_;
  const Vjp<T>* vjp_;
  const Jacobian<T>* jacobian_;
  const GradientProjection<T>* projection_;
  Index batch_, batches_, drawn_, at_ = 0;
  bool fresh_;
  /// All slices, or a fresh batch; the current batch starts at column `first_`.
  Batch<T> target_, given_, input_;
  Index first_ = 0;
  Batch<T> y_, y_bar_;
  Vector<double> loss_;
  Tape tape_;
  Workspace work_;
  Counts counts_;
};

extern template class Minibatch<float>;
extern template class Minibatch<double>;

}  // namespace physinv
