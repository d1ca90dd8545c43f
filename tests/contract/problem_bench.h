/// What the contracts of problems look at them with: answers by value,
/// directions, derivatives by differences.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "suite/core/problem.h"
#include "suite/core/recipe.h"

namespace physinv::test {

/// A problem with its scratch, and its answers by value.
template <class T>
struct ProblemBench {
  explicit ProblemBench(const ProblemRecipe& recipe, Threads* threads = nullptr)
      : problem(recipe.make<T>()),
        vjp(dynamic_cast<const Vjp<T>*>(problem.get())),
        jac(dynamic_cast<const Jacobian<T>*>(problem.get())),
        tape(threads),
        work(threads) {}

  Batch<T> forward(const Batch<T>& x, const Batch<T>& given) {
    Batch<T> seen(problem->shape().observations, x.cols());
    problem->forward({x, given}, seen, work);
    return seen;
  }
  Batch<T> jacobian(const Batch<T>& x, const Batch<T>& given) {
    const Shape shape = problem->shape();
    Batch<T> j(shape.observations * shape.unknowns, x.cols());
    jac->jacobian({x, given}, j, work);
    return j;
  }
  /// Leaves y of the linearization in `y`.
  Batch<T> pull(const Batch<T>& x,
                const Batch<T>& given,
                const Batch<T>& y_bar) {
    y.resize(problem->shape().observations, x.cols());
    Batch<T> x_bar(problem->shape().unknowns, x.cols());
    vjp->linearize({x, given}, y, tape);
    vjp->pullback(tape, y_bar, x_bar, work);
    return x_bar;
  }

  /// Gradient of y_bar . y at x by central differences, step h max(1, |x_j|),
  /// many of them at once.
  Vector<T> difference(const Vector<T>& x,
                       const Vector<T>& given,
                       const Vector<T>& y_bar,
                       T h) {
    constexpr Index kAtOnce = 32;
    Vector<T> g(x.size());
    for (Index first = 0; first < x.size(); first += kAtOnce) {
      const Index count = std::min(kAtOnce, x.size() - first);
      Batch<T> up = x.replicate(1, count), down = up;
      Vector<T> width(count);
      for (Index k = 0; k < count; ++k) {
        const T at = x(first + k), step = h * std::max(T(1), std::abs(at));
        up(first + k, k) = at + step, down(first + k, k) = at - step;
        width(k) = 2 * step;
      }
      const Batch<T> shown = given.replicate(1, count);
      const Batch<T> change = forward(up, shown) - forward(down, shown);
      g.segment(first, count) =
          (change.transpose() * y_bar).cwiseQuotient(width);
    }
    return g;
  }

  std::unique_ptr<Problem<T>> problem;
  const Vjp<T>* vjp;
  const Jacobian<T>* jac;
  Batch<T> y;
  Tape tape;
  Workspace work;
};

template <class T>
Batch<T> directions(Index rows, Index cols, double shift) {
  return Batch<T>::NullaryExpr(rows, cols, [=](Index i, Index j) {
    return static_cast<T>(std::sin(1.7 * double(i) + 0.9 * double(j) + shift));
  });
}

/// A derivative that hardly depends on the step, or nothing at a kink.
template <class F>
bool smooth_derivative(F&& along, Vector<double>& d, double step = 1e-6) {
  d = along(step);
  const Vector<double> wide = along(4 * step);
  if (!d.allFinite() || !wide.allFinite()) return false;
  return (d - wide).cwiseAbs().maxCoeff() <=
         1e-6 * (1 + d.cwiseAbs().maxCoeff());
}

}  // namespace physinv::test
