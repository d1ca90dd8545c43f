#include "suite/core/counted_problem.h"

#include "suite/core/check.h"

namespace physinv {

template <class T>
void CountedProblem<T>::forward(BatchIn<T> x, BatchIn<T> given, BatchOut<T> y) {
  problem_.forward(x, given, y, work_);
  count(Counter::forward, x.cols());
}

template <class T>
void CountedProblem<T>::linearize(BatchIn<T> x,
                                  BatchIn<T> given,
                                  BatchOut<T> y) {
  problem_.linearize(x, given, y, tape_);
  linearized_ = x.cols();
}

template <class T>
void CountedProblem<T>::pullback(BatchIn<T> y_bar, BatchOut<T> x_bar) {
  check_size(x_bar, x_bar.rows(), linearized_);
  problem_.pullback(tape_, y_bar, x_bar, work_);
  count(Counter::vjp, x_bar.cols());
}

template <class T>
void CountedProblem<T>::pushforward(BatchIn<T> x_dot, BatchOut<T> y_dot) {
  check_size(x_dot, x_dot.rows(), linearized_);
  problem_.pushforward(tape_, x_dot, y_dot, work_);
}

template <class T>
void CountedProblem<T>::pullback_tangent(BatchIn<T> x_dot,
                                         BatchIn<T> y_bar,
                                         BatchIn<T> y_bar_dot,
                                         BatchOut<T> x_bar_dot) {
  check_size(x_dot, x_dot.rows(), linearized_);
  problem_.pullback_tangent(tape_, {x_dot, y_bar, y_bar_dot}, x_bar_dot, work_);
  count(Counter::vjp, x_dot.cols());
}

template <class T>
void CountedProblem<T>::jacobian(BatchIn<T> x,
                                 BatchIn<T> given,
                                 BatchOut<T> y,
                                 BatchOut<T> j) {
  problem_.forward(x, given, y, work_);
  problem_.jacobian(x, given, j, work_);
  count(Counter::jacobian, x.cols());
}

template <class T>
void CountedProblem<T>::hessian(BatchIn<T> x,
                                BatchIn<T> given,
                                BatchIn<T> target,
                                BatchOut<T> h) {
  problem_.hessian(x, given, target, h, work_);
  count(Counter::jacobian, x.cols());
}

template <class T>
void CountedProblem<T>::invert(BatchIn<T> y,
                               BatchIn<T> given,
                               BatchIn<T> x_guess,
                               BatchOut<T> x) {
  problem_.invert(y, given, x_guess, x, work_);
  count(Counter::inverse, y.cols());
}

template <class T>
void CountedProblem<T>::newton_step(BatchIn<T> x,
                                    BatchIn<T> given,
                                    BatchIn<T> target,
                                    BatchOut<T> dx) {
  problem_.newton_step(x, given, target, dx);
  count(Counter::vjp, x.cols());
}

template <class T>
void CountedProblem<T>::inverse_gradient_step(BatchIn<T> x,
                                              BatchIn<T> given,
                                              BatchIn<T> target,
                                              BatchOut<T> dx) {
  problem_.inverse_gradient_step(x, given, target, dx);
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
