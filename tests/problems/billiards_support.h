/// One call that runs everything a billiards problem can do.
#pragma once

#include <array>

#include "problems/billiards/billiards.h"
#include "suite/core/any_problem.h"

namespace physinv::test {

using Point = std::array<double, 2>;

/// Everything one linearization and one pullback give.
template <class T>
struct Result {
  Batch<T> y, x_bar, jacobian, y_forward;
  Vector<double> loss;
  Counts linearized, pulled;
};

template <class T>
Result<T> evaluate(const Batch<T>& x,
                   const Batch<T>& given,
                   const Batch<T>* y_bar = nullptr,
                   const BilliardsOptions& options = {}) {
  const AnyProblem<T> problem(problems::billiards(options));
  const Index n = x.cols();
  Result<T> r;
  r.y.resize(2, n), r.x_bar.resize(2, n), r.jacobian.resize(4, n);
  r.y_forward.resize(2, n), r.loss.resize(n);
  Batch<T> target(2, n), g(2, n);
  for (Index k = 0; k < 2; ++k)
    target.row(k).setConstant(T(options.target[std::size_t(k)]));
  Tape tape;
  Workspace work, other;
  problem.linearize(x, given, r.y, tape);
  problem.loss(r.y, target, r.loss);
  if (y_bar != nullptr) {
    g = *y_bar;
  } else {
    problem.loss_gradient(r.y, target, g);
  }
  problem.pullback(tape, g, r.x_bar, work);
  problem.jacobian(x, given, r.jacobian, other);
  problem.forward(x, given, r.y_forward, other);
  r.linearized = tape.counts, r.pulled = work.counts;
  return r;
}

template <class T>
Result<T> evaluate_one(Point v,
                       Point ball,
                       const BilliardsOptions& options = {}) {
  Batch<T> x(2, 1), given(2, 1);
  x << T(v[0]), T(v[1]);
  given << T(ball[0]), T(ball[1]);
  return evaluate<T>(x, given, nullptr, options);
}

}  // namespace physinv::test
