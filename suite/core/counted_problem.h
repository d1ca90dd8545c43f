/// A problem for methods that call it themselves, anywhere and on any data:
/// every run of it is counted, in memory of its own. The oracle hands it out
/// (`Oracle::problem`); its user adds its counts (`Oracle::add`).
#pragma once

#include "suite/core/any_problem.h"

namespace physinv {

/// Calls are those of AnyProblem.
template <class T>
class CountedProblem {
 public:
  CountedProblem(std::unique_ptr<const Problem<T>> problem,
                 Needs allowed,
                 Threads* threads = nullptr)
      : problem_(std::move(problem), allowed), tape_(threads), work_(threads) {}

  // Of a point whose observations are known: not counted.
  void loss(BatchIn<T> y, BatchIn<T> target, VectorOut<double> loss) const {
    problem_.loss(y, target, loss);
  }
  void loss_gradient(BatchIn<T> y, BatchIn<T> target, BatchOut<T> y_bar) const {
    problem_.loss_gradient(y, target, y_bar);
  }
  void project(BatchIn<T> y, BatchOut<T> y_bar) const {
    problem_.project(y, y_bar);
  }

  /// Counted as `forward`.
  void forward(BatchIn<T> x, BatchIn<T> given, BatchOut<T> y);

  /// Forward pass in front of pullbacks, which are counted as `vjp`.
  void linearize(BatchIn<T> x, BatchIn<T> given, BatchOut<T> y);
  void pullback(BatchIn<T> y_bar, BatchOut<T> x_bar);
  /// In front of one of the pullbacks of a product with a Hessian.
  void pushforward(BatchIn<T> x_dot, BatchOut<T> y_dot);
  void pullback_tangent(BatchIn<T> x_dot,
                        BatchIn<T> y_bar,
                        BatchIn<T> y_bar_dot,
                        BatchOut<T> x_bar_dot);

  /// y and the full Jacobians there, counted as `jacobian`.
  void jacobian(BatchIn<T> x, BatchIn<T> given, BatchOut<T> y, BatchOut<T> j);
  /// Counted as `jacobian`, too: second derivatives are of that size.
  void hessian(BatchIn<T> x,
               BatchIn<T> given,
               BatchIn<T> target,
               BatchOut<T> h);
  /// Counted as `inverse`.
  void invert(BatchIn<T> y,
              BatchIn<T> given,
              BatchIn<T> x_guess,
              BatchOut<T> x);

  /// ClosedSteps, counted as the `vjp` and the `jacobian` that they stand for.
  bool has_closed_steps() const { return problem_.has_closed_steps(); }
  void newton_step(BatchIn<T> x,
                   BatchIn<T> given,
                   BatchIn<T> target,
                   BatchOut<T> dx);
  void inverse_gradient_step(BatchIn<T> x,
                             BatchIn<T> given,
                             BatchIn<T> target,
                             BatchOut<T> dx);

  /// What was run, and what its kernels did and saved.
  Counts counts() const;
  std::size_t bytes() const { return tape_.bytes() + work_.bytes(); }

 private:
  void count(Counter counter, Index n) {
    counts_[counter] += static_cast<std::uint64_t>(n);
  }

  AnyProblem<T> problem_;
  Index linearized_ = 0;  ///< samples of the last `linearize`
  Tape tape_;
  Workspace work_;
  Counts counts_;
};

extern template class CountedProblem<float>;
extern template class CountedProblem<double>;

}  // namespace physinv
