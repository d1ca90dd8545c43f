/// A problem with the calls of all abilities, as its recipe makes it: for
/// callers that hold arrays. Sizes are checked here, once for all problems.
#pragma once

#include <functional>
#include <memory>

#include "suite/core/closed_steps.h"
#include "suite/core/gradient_projection.h"
#include "suite/core/recipe.h"

namespace physinv {

/// A call of an ability that the problem lacks, or that is not among `allowed`,
/// and arrays of the wrong size are ContractErrors.
template <class T>
class AnyProblem {
 public:
  explicit AnyProblem(const ProblemRecipe& recipe)
      : AnyProblem(recipe.make<T>(), recipe.provided) {
    exact_ = recipe.make_double;
  }
  AnyProblem(std::unique_ptr<const Problem<T>> problem, Needs allowed);

  const Problem<T>& problem() const { return *problem_; }
  Shape shape() const { return shape_; }
  Vector<double> start() const { return problem_->start(); }
  /// Of the recipe, which are drawn in double whatever T is.
  Samples<double> sample(Index first, Index count, const Rng& rng) const {
    return exact_()->sample(first, count, rng);
  }
  Samples<double> sample_labelled(Index first,
                                  Index count,
                                  const Rng& rng) const {
    return exact_()->sample_labelled(first, count, rng);
  }

  void forward(BatchIn<T> x,
               BatchIn<T> given,
               BatchOut<T> y,
               Workspace& work) const;
  void loss(BatchIn<T> y, BatchIn<T> target, VectorOut<double> loss) const;
  void loss_gradient(BatchIn<T> y, BatchIn<T> target, BatchOut<T> y_bar) const;
  /// GradientProjection, if the problem has one.
  void project(BatchIn<T> y, BatchOut<T> y_bar) const;

  void linearize(BatchIn<T> x,
                 BatchIn<T> given,
                 BatchOut<T> y,
                 Tape& tape) const;
  /// Of as many samples as the last `linearize` on this tape.
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const;
  void pushforward(const Tape& tape,
                   BatchIn<T> x_dot,
                   BatchOut<T> y_dot,
                   Workspace& work) const;
  void pullback_tangent(const Tape& tape,
                        Directions<T> along,
                        BatchOut<T> x_bar_dot,
                        Workspace& work) const;

  void jacobian(BatchIn<T> x,
                BatchIn<T> given,
                BatchOut<T> j,
                Workspace& work) const;
  void hessian(BatchIn<T> x,
               BatchIn<T> given,
               BatchIn<T> target,
               BatchOut<T> h,
               Workspace& work) const;
  void invert(BatchIn<T> y,
              BatchIn<T> given,
              BatchIn<T> x_guess,
              BatchOut<T> x,
              Workspace& work) const;

  bool has_closed_steps() const { return closed_ != nullptr; }
  void newton_step(BatchIn<T> x,
                   BatchIn<T> given,
                   BatchIn<T> target,
                   BatchOut<T> dx) const;
  void inverse_gradient_step(BatchIn<T> x,
                             BatchIn<T> given,
                             BatchIn<T> target,
                             BatchOut<T> dx) const;

 private:
  /// x and given of so many samples.
  void check_point(BatchIn<T> x, BatchIn<T> given, Index samples) const;
  const ClosedSteps<T>& closed_for(Needs needs) const;

  std::unique_ptr<const Problem<T>> problem_;
  std::function<std::unique_ptr<Problem<double>>()> exact_;
  Shape shape_;
  // The abilities that may be used; null if the problem lacks one or it is not
  // allowed.
  const Vjp<T>* vjp_;
  const Jvp<T>* jvp_;
  const PullbackTangent<T>* pullback_tangent_;
  const Jacobian<T>* jacobian_;
  const Hessian<T>* hessian_;
  const Inverse<T>* inverse_;
  const ClosedSteps<T>* closed_;
  const GradientProjection<T>* projection_;
  Needs allowed_;
};

extern template class AnyProblem<float>;
extern template class AnyProblem<double>;

}  // namespace physinv
