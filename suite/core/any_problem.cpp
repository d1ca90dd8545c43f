#include "suite/core/any_problem.h"

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
              "the method used a capability that it did not declare");
  return *ability;
}

}  // namespace

template <class T>
AnyProblem<T>::AnyProblem(std::unique_ptr<const Problem<T>> problem,
                          Needs allowed)
    : problem_(std::move(problem)),
      shape_(problem_->shape()),
      vjp_(ability<Vjp<T>>(*problem_, allowed, Needs::vjp)),
      jvp_(ability<Jvp<T>>(*problem_, allowed, Needs::jvp)),
      pullback_tangent_(ability<PullbackTangent<T>>(
          *problem_, allowed, Needs::pullback_tangent)),
      jacobian_(ability<Jacobian<T>>(*problem_, allowed, Needs::jacobian)),
      hessian_(ability<Hessian<T>>(*problem_, allowed, Needs::hessian)),
      inverse_(ability<Inverse<T>>(*problem_, allowed, Needs::inverse)),
      closed_(dynamic_cast<const ClosedSteps<T>*>(problem_.get())),
      projection_(dynamic_cast<const GradientProjection<T>*>(problem_.get())),
      allowed_(allowed) {}

template <class T>
void AnyProblem<T>::check_point(BatchIn<T> x,
                                BatchIn<T> given,
                                Index samples) const {
  check_size(x, shape_.unknowns, samples);
  check_size(given, shape_.given, samples);
}

template <class T>
void AnyProblem<T>::forward(BatchIn<T> x,
                            BatchIn<T> given,
                            BatchOut<T> y,
                            Workspace& work) const {
  check_point(x, given, y.cols());
  check_size(y, shape_.observations, y.cols());
  problem_->forward({x, given}, y, work);
}

template <class T>
void AnyProblem<T>::loss(BatchIn<T> y,
                         BatchIn<T> target,
                         VectorOut<double> loss) const {
  check_size(y, shape_.observations, loss.size());
  check_size(target, shape_.observations, loss.size());
  problem_->loss(y, target, loss);
}

template <class T>
void AnyProblem<T>::loss_gradient(BatchIn<T> y,
                                  BatchIn<T> target,
                                  BatchOut<T> y_bar) const {
  for (const auto* b : {&y, &target})
    check_size(*b, shape_.observations, y_bar.cols());
  check_size(y_bar, shape_.observations, y_bar.cols());
  problem_->loss_gradient(y, target, y_bar);
}

template <class T>
void AnyProblem<T>::project(BatchIn<T> y, BatchOut<T> y_bar) const {
  check_size(y_bar, y.rows(), y.cols());
  if (projection_ != nullptr) projection_->project(y, y_bar);
}

template <class T>
void AnyProblem<T>::linearize(BatchIn<T> x,
                              BatchIn<T> given,
                              BatchOut<T> y,
                              Tape& tape) const {
  check_point(x, given, y.cols());
  check_size(y, shape_.observations, y.cols());
  declared(vjp_).linearize({x, given}, y, tape);
}

template <class T>
void AnyProblem<T>::pullback(const Tape& tape,
                             BatchIn<T> y_bar,
                             BatchOut<T> x_bar,
                             Workspace& work) const {
  check_size(y_bar, shape_.observations, y_bar.cols());
  check_size(x_bar, shape_.unknowns, y_bar.cols());
  declared(vjp_).pullback(tape, y_bar, x_bar, work);
}

template <class T>
void AnyProblem<T>::pushforward(const Tape& tape,
                                BatchIn<T> x_dot,
                                BatchOut<T> y_dot,
                                Workspace& work) const {
  check_size(x_dot, shape_.unknowns, x_dot.cols());
  check_size(y_dot, shape_.observations, x_dot.cols());
  declared(jvp_).pushforward(tape, x_dot, y_dot, work);
}

template <class T>
void AnyProblem<T>::pullback_tangent(const Tape& tape,
                                     Directions<T> along,
                                     BatchOut<T> x_bar_dot,
                                     Workspace& work) const {
  const Index samples = x_bar_dot.cols();
  check_size(along.x_dot, shape_.unknowns, samples);
  check_size(along.y_bar, shape_.observations, samples);
  check_size(along.y_bar_dot, shape_.observations, samples);
  check_size(x_bar_dot, shape_.unknowns, samples);
  declared(pullback_tangent_).pullback_tangent(tape, along, x_bar_dot, work);
}

template <class T>
void AnyProblem<T>::jacobian(BatchIn<T> x,
                             BatchIn<T> given,
                             BatchOut<T> j,
                             Workspace& work) const {
  check_point(x, given, j.cols());
  check_size(j, shape_.observations * shape_.unknowns, j.cols());
  declared(jacobian_).jacobian({x, given}, j, work);
}

template <class T>
void AnyProblem<T>::hessian(BatchIn<T> x,
                            BatchIn<T> given,
                            BatchIn<T> target,
                            BatchOut<T> h,
                            Workspace& work) const {
  check_point(x, given, h.cols());
  check_size(target, shape_.observations, h.cols());
  check_size(h, shape_.unknowns * shape_.unknowns, h.cols());
  declared(hessian_).hessian({x, given}, target, h, work);
}

template <class T>
void AnyProblem<T>::invert(BatchIn<T> y,
                           BatchIn<T> given,
                           BatchIn<T> x_guess,
                           BatchOut<T> x,
                           Workspace& work) const {
  check_point(x_guess, given, x.cols());
  check_size(y, shape_.observations, x.cols());
  check_size(x, shape_.unknowns, x.cols());
  declared(inverse_).invert({x_guess, given}, y, x, work);
}

template <class T>
const ClosedSteps<T>& AnyProblem<T>::closed_for(Needs needs) const {
  return declared(contains(allowed_, needs) ? closed_ : nullptr);
}

template <class T>
void AnyProblem<T>::newton_step(BatchIn<T> x,
                                BatchIn<T> given,
                                BatchIn<T> target,
                                BatchOut<T> dx) const {
  check_point(x, given, dx.cols());
  check_size(target, shape_.observations, dx.cols());
  check_size(dx, shape_.unknowns, dx.cols());
  closed_for(Needs::hessian).newton_step({x, given}, target, dx);
}

template <class T>
void AnyProblem<T>::inverse_gradient_step(BatchIn<T> x,
                                          BatchIn<T> given,
                                          BatchIn<T> target,
                                          BatchOut<T> dx) const {
  check_point(x, given, dx.cols());
  check_size(target, shape_.observations, dx.cols());
  check_size(dx, shape_.unknowns, dx.cols());
  closed_for(Needs::jacobian).inverse_gradient_step({x, given}, target, dx);
}

template class AnyProblem<float>;
template class AnyProblem<double>;

}  // namespace physinv
