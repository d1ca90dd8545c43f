/// Central differences, in double, for tests only.
#pragma once

#include <algorithm>
#include <cmath>

#include "suite/core/batch.h"

namespace physinv::test {

/// Gradient of the scalar f at x, step h times max(1, |x_j|).
template <class F>
Vector<double> difference_gradient(F&& f, Vector<double> x, double h = 1e-6) {
  Vector<double> g(x.size());
  for (Index j = 0; j < x.size(); ++j) {
    const double at = x(j), step = h * std::max(1.0, std::abs(at));
    x(j) = at + step;
    const double up = f(x);
    x(j) = at - step;
    const double down = f(x);
    x(j) = at;
    g(j) = (up - down) / (2 * step);
  }
  return g;
}

/// Jacobian (outputs x unknowns) of the vector function f at x.
template <class F>
Batch<double> difference_jacobian(F&& f, Vector<double> x, double h = 1e-6) {
  Batch<double> jacobian;
  for (Index j = 0; j < x.size(); ++j) {
    const double at = x(j), step = h * std::max(1.0, std::abs(at));
    x(j) = at + step;
    const Vector<double> up = f(x);
    x(j) = at - step;
    const Vector<double> down = f(x);
    x(j) = at;
    jacobian.conservativeResize(up.size(), x.size());
    jacobian.col(j) = (up - down) / (2 * step);
  }
  return jacobian;
}

/// Directional derivative of the vector function f at x along v.
template <class F>
Vector<double> difference_along(F&& f,
                                const Vector<double>& x,
                                const Vector<double>& v,
                                double h = 1e-6) {
  const Vector<double> up = f(Vector<double>(x + h * v));
  const Vector<double> down = f(Vector<double>(x - h * v));
  return (up - down) / (2 * h);
}

}  // namespace physinv::test
