/// A problem for methods that call it themselves, anywhere and on any data:
/// every run of it is counted, in memory of its own. The oracle hands it out
/// (`Oracle::problem`); whoever runs it gives its counts back (`Oracle::add`).
#pragma once

#include <memory>

#include "suite/core/closed_steps.h"
#include "suite/core/gradient_projection.h"
#include "suite/core/problem.h"

namespace physinv {

/// Calls are those of the problem's abilities; one that it lacks, or that is
/// not among `allowed`, is refused.
template <class T>
class CountedProblem {
 public:
  CountedProblem(std::unique_ptr<const Problem<T>> problem,
                 Needs allowed,
                 Threads* threads = nullptr);

  // Of a point whose observations are known: not counted.
  void loss(BatchIn<T> y, BatchIn<T> target, VectorOut<double> loss) const {
    problem_->loss(y, target, loss);
  }
  void loss_gradient(BatchIn<T> y, BatchIn<T> target, BatchOut<T> y_bar) const {
    problem_->loss_gradient(y, target, y_bar);
  }
  /// GradientProjection, if the problem has one.
  void project(BatchIn<T> y, BatchOut<T> y_bar) const;

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
  bool has_closed_steps() const { return closed_ != nullptr; }
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
  const ClosedSteps<T>& closed_for(Needs needs) const;
  void count(Counter counter, Index n) {
    counts_[counter] += static_cast<std::uint64_t>(n);
  }

  std::unique_ptr<const Problem<T>> problem_;
  // The abilities that may be used; null if the problem lacks one or the
  // method did not declare it.
  const Vjp<T>* vjp_;
  const Jvp<T>* jvp_;
  const PullbackTangent<T>* pullback_tangent_;
  const Jacobian<T>* jacobian_;
  const Hessian<T>* hessian_;
  const Inverse<T>* inverse_;
  const ClosedSteps<T>* closed_;
  const GradientProjection<T>* projection_;
  Needs allowed_;
  Tape tape_;
  Workspace work_;
  Counts counts_;
};

extern template class CountedProblem<float>;
extern template class CountedProblem<double>;

}  // namespace physinv
