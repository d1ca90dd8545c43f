#include "suite/core/counted_problem.h"

#include <utility>

#include "suite/core/check.h"

namespace physinv {

template <class T>
CountedProblem<T>::CountedProblem(std::unique_ptr<const Problem<T>> problem,
                                  Needs allowed,
                                  Threads* threads)
    : problem_(std::move(problem)),
      closed_(dynamic_cast<const ClosedSteps<T>*>(problem_.get())),
      projection_(dynamic_cast<const GradientProjection<T>*>(problem_.get())),
      allowed_(allowed),
      tape_(threads),
      work_(threads) {}

template <class T>
template <class Ability>
const Ability& CountedProblem<T>::as(Needs needs) const {
  const auto* ability = dynamic_cast<const Ability*>(problem_.get());
  SUITE_CHECK(ability != nullptr && contains(allowed_, needs),
              "the method asked for what it did not declare");
  return *ability;
}

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
  as<Vjp<T>>(Needs::vjp).linearize(x, given, y, tape_);
}

template <class T>
void CountedProblem<T>::pullback(BatchIn<T> y_bar, BatchOut<T> x_bar) {
  as<Vjp<T>>(Needs::vjp).pullback(tape_, y_bar, x_bar, work_);
  count(Counter::vjp, x_bar.cols());
}

template <class T>
void CountedProblem<T>::pushforward(BatchIn<T> x_dot, BatchOut<T> y_dot) {
  as<Jvp<T>>(Needs::jvp).pushforward(tape_, x_dot, y_dot, work_);
}

template <class T>
void CountedProblem<T>::pullback_tangent(BatchIn<T> x_dot,
                                         BatchIn<T> y_bar,
                                         BatchIn<T> y_bar_dot,
                                         BatchOut<T> x_bar_dot) {
  as<PullbackTangent<T>>(Needs::pullback_tangent)
      .pullback_tangent(tape_, x_dot, y_bar, y_bar_dot, x_bar_dot, work_);
  count(Counter::vjp, x_dot.cols());
}

template <class T>
void CountedProblem<T>::jacobian(BatchIn<T> x,
                                 BatchIn<T> given,
                                 BatchOut<T> y,
                                 BatchOut<T> j) {
  const auto& full = as<Jacobian<T>>(Needs::jacobian);
  problem_->forward(x, given, y, work_);
  full.jacobian(x, given, j, work_);
  count(Counter::jacobian, x.cols());
}

template <class T>
void CountedProblem<T>::hessian(BatchIn<T> x,
                                BatchIn<T> given,
                                BatchIn<T> target,
                                BatchOut<T> h) {
  as<Hessian<T>>(Needs::hessian).hessian(x, given, target, h, work_);
  count(Counter::jacobian, x.cols());
}

template <class T>
void CountedProblem<T>::invert(BatchIn<T> y,
                               BatchIn<T> given,
                               BatchIn<T> x_guess,
                               BatchOut<T> x) {
  as<Inverse<T>>(Needs::inverse).invert(y, given, x_guess, x, work_);
  count(Counter::inverse, y.cols());
}

template <class T>
void CountedProblem<T>::newton_step(BatchIn<T> x,
                                    BatchIn<T> given,
                                    BatchIn<T> target,
                                    BatchOut<T> dx) {
  as<ClosedSteps<T>>(Needs::hessian).newton_step(x, given, target, dx);
  count(Counter::vjp, x.cols());
}

template <class T>
void CountedProblem<T>::inverse_gradient_step(BatchIn<T> x,
                                              BatchIn<T> given,
                                              BatchIn<T> target,
                                              BatchOut<T> dx) {
  as<ClosedSteps<T>>(Needs::jacobian)
      .inverse_gradient_step(x, given, target, dx);
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
