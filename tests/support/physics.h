/// A problem's answers by value.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "suite/core/any_problem.h"
#include "suite/core/problem.h"
#include "suite/core/threads.h"
#include "tests/support/bits.h"

namespace physinv::test {

template <template <class> class P, class T>
T number_of(const P<T>&);

/// A problem with its scratch, on so many threads: `Physics at(problem)` refers
/// to one, `Physics at{AnyProblem<float>(problems::heat(options))}` has its
/// own.
template <class P>
struct Physics {
  using T = decltype(number_of(std::declval<const P&>()));

  explicit Physics(P p, int thread_count = 1)
      : problem(std::forward<P>(p)),
        threads(thread_count),
        work(&threads),
        tape(&threads) {}

  Batch<T> forward(const Batch<T>& x, const Batch<T>& given) {
    Batch<T> y(problem.shape().observations, x.cols());
    problem.forward(x, given, y, work);
    return y;
  }
  Batch<T> linearize(const Batch<T>& x, const Batch<T>& given) {
    Batch<T> y(problem.shape().observations, x.cols());
    problem.linearize(x, given, y, tape);
    return y;
  }
  /// At the point of the last linearize.
  Batch<T> pullback(const Batch<T>& y_bar) {
    Batch<T> x_bar(problem.shape().unknowns, y_bar.cols());
    problem.pullback(tape, y_bar, x_bar, work);
    return x_bar;
  }
  /// At a y that has the bits of `forward`.
  Batch<T> gradient(const Batch<T>& x,
                    const Batch<T>& given,
                    const Batch<T>& y_bar) {
    const Batch<T> y = linearize(x, given);
    const Batch<T> x_bar = pullback(y_bar);
    EXPECT_TRUE(same_bits(y, forward(x, given)));
    return x_bar;
  }
  Batch<T> jacobian(const Batch<T>& x, const Batch<T>& given) {
    const Shape s = problem.shape();
    Batch<T> j(s.observations * s.unknowns, x.cols());
    problem.jacobian(x, given, j, work);
    return j;
  }
  Batch<T> invert(const Batch<T>& y,
                  const Batch<T>& given,
                  const Batch<T>& x_guess) {
    Batch<T> x(x_guess);
    problem.invert(y, given, x_guess, x, work);
    return x;
  }
  /// Sample i's matrix.
  Batch<T> matrix(const Batch<T>& j, Index i) const {
    const Shape s = problem.shape();
    return Eigen::Map<const Batch<T>>(
        j.col(i).data(), s.observations, s.unknowns);
  }

  struct Losses {
    Batch<T> y;
    Vector<double> loss;
    Batch<T> x_bar;  ///< the gradient of each loss
  };
  /// Of every column of x against the same column of `target`.
  Losses losses(const Batch<T>& x,
                const Batch<T>& given,
                const Batch<T>& target) {
    Losses of{linearize(x, given), Vector<double>(x.cols()), {}};
    Batch<T> y_bar(of.y);
    problem.loss(of.y, target, of.loss);
    problem.loss_gradient(of.y, target, y_bar);
    of.x_bar = pullback(y_bar);
    return of;
  }

  P problem;
  Threads threads;
  Workspace work;
  Tape tape;
};
template <class P>
Physics(P&&, int = 1) -> Physics<P>;

template <class T>
Batch<T> waves(Index rows, Index cols, double shift) {
  return Batch<T>::NullaryExpr(rows, cols, [=](Index i, Index j) {
    return static_cast<T>(std::sin(1.7 * double(i) + 0.9 * double(j) + shift));
  });
}

}  // namespace physinv::test
