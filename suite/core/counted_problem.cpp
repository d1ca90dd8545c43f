#include "suite/core/counted_problem.h"

#include <utility>

#include "suite/core/check.h"

namespace physinv {
namespace {

/// Null if the problem lacks it or it is not allowed.
template <class Ability, class T>
const Ability* ability(const Problem<T>& problem, Needs allowed, Needs needs) {
  return contains(allowed, needs) ? dynamic_cast<const Ability*>(&problem)
                                  : nullptr;
}

template <class Ability>
const Ability& declared(const Ability* ability) {
  SUITE_CHECK(ability != nullptr,
              "the method asked for what it did not declare");
  return *ability;
}

}  // namespace

template <class T>
CountedProblem<T>::CountedProblem(std::unique_ptr<const Problem<T>> problem,
                                  Needs allowed,
                                  Threads* threads)
    : problem_(std::move(problem)),
      vjp_(ability<Vjp<T>>(*problem_, allowed, Needs::vjp)),
      jvp_(ability<Jvp<T>>(*problem_, allowed, Needs::jvp)),
      pullback_tangent_(ability<PullbackTangent<T>>(
          *problem_, allowed, Needs::pullback_tangent)),
      jacobian_(ability<Jacobian<T>>(*problem_, allowed, Needs::jacobian)),
      hessian_(ability<Hessian<T>>(*problem_, allowed, Needs::hessian)),
      inverse_(ability<Inverse<T>>(*problem_, allowed, Needs::inverse)),
      closed_(dynamic_cast<const ClosedSteps<T>*>(problem_.get())),
      projection_(dynamic_cast<const GradientProjection<T>*>(problem_.get())),
      allowed_(allowed),
      tape_(threads),
      work_(threads) {}

template <class T>
void CountedProblem<T>::project(BatchIn<T> y, BatchOut<T> y_bar) const {
  if (projection_ != nullptr) projection_->project(y, y_bar);
}

template <class T>
void CountedProblem<T>::forward(BatchIn<T> x, BatchIn<T> given, BatchOut<T> y) {
  problem_->forward(x, given, y, work_);
  count(Counter::forward, x.cols());
}

template <class T>
void CountedProblem<T>::linearize(BatchIn<T> x,
                                  BatchIn<T> given,
                                  BatchOut<T> y) {
  declared(vjp_).linearize(x, given, y, tape_);
}

template <class T>
void CountedProblem<T>::pullback(BatchIn<T> y_bar, BatchOut<T> x_bar) {
  declared(vjp_).pullback(tape_, y_bar, x_bar, work_);
  count(Counter::vjp, x_bar.cols());
}

template <class T>
void CountedProblem<T>::pushforward(BatchIn<T> x_dot, BatchOut<T> y_dot) {
  declared(jvp_).pushforward(tape_, x_dot, y_dot, work_);
}

template <class T>
void CountedProblem<T>::pullback_tangent(BatchIn<T> x_dot,
                                         BatchIn<T> y_bar,
                                         BatchIn<T> y_bar_dot,
                                         BatchOut<T> x_bar_dot) {
  declared(pullback_tangent_)
      .pullback_tangent(tape_, x_dot, y_bar, y_bar_dot, x_bar_dot, work_);
  count(Counter::vjp, x_dot.cols());
}

template <class T>
void CountedProblem<T>::jacobian(BatchIn<T> x,
                                 BatchIn<T> given,
                                 BatchOut<T> y,
                                 BatchOut<T> j) {
  const auto& full = declared(jacobian_);
  problem_->forward(x, given, y, work_);
  full.jacobian(x, given, j, work_);
  count(Counter::jacobian, x.cols());
}

template <class T>
void CountedProblem<T>::hessian(BatchIn<T> x,
                                BatchIn<T> given,
                                BatchIn<T> target,
                                BatchOut<T> h) {
  declared(hessian_).hessian(x, given, target, h, work_);
  count(Counter::jacobian, x.cols());
}

template <class T>
void CountedProblem<T>::invert(BatchIn<T> y,
                               BatchIn<T> given,
                               BatchIn<T> x_guess,
                               BatchOut<T> x) {
  declared(inverse_).invert(y, given, x_guess, x, work_);
  count(Counter::inverse, y.cols());
}

template <class T>
const ClosedSteps<T>& CountedProblem<T>::closed_for(Needs needs) const {
  return declared(contains(allowed_, needs) ? closed_ : nullptr);
}

template <class T>
void CountedProblem<T>::newton_step(BatchIn<T> x,
                                    BatchIn<T> given,
                                    BatchIn<T> target,
                                    BatchOut<T> dx) {
  closed_for(Needs::hessian).newton_step(x, given, target, dx);
  count(Counter::vjp, x.cols());
}

template <class T>
void CountedProblem<T>::inverse_gradient_step(BatchIn<T> x,
                                              BatchIn<T> given,
                                              BatchIn<T> target,
                                              BatchOut<T> dx) {
  closed_for(Needs::jacobian).inverse_gradient_step(x, given, target, dx);
  count(Counter::jacobian, x.cols());
}

template <class T>
Counts CountedProblem<T>::counts() const {
  Counts all = counts_;
  all += tape_.counts;
  all += work_.counts;
  return all;
}

template class CountedProblem<float>;
template class CountedProblem<double>;

}  // namespace physinv
