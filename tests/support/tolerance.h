/// Comparisons: |a - b| <= atol + rtol max|b| over the whole array, because
/// entries near zero carry the rounding noise of the large ones.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "suite/core/batch.h"

namespace physinv::test {

/// What a computation in T may lose in a short chain of operations.
template <class T>
struct Tolerance;
template <>
struct Tolerance<double> {
  static constexpr double relative = 1e-12;
};
template <>
struct Tolerance<float> {
  static constexpr double relative = 1e-4;
};

/// An entry that is not finite equals only its own kind.
class Comparator {
 public:
  Comparator(double rtol, double atol) : rtol_(rtol), atol_(atol) {}

  double rtol() const { return rtol_; }
  double atol() const { return atol_; }

  template <class A, class B>
  testing::AssertionResult operator()(
      const Eigen::MatrixBase<A>& found,
      const Eigen::MatrixBase<B>& wanted) const {
    // Entry by entry, a product would be computed anew for each.
    const auto& a = found.eval();
    const auto& b = wanted.eval();
    if (a.rows() != b.rows() || a.cols() != b.cols()) {
      return testing::AssertionFailure()
             << "shape " << a.rows() << "x" << a.cols() << ", expected "
             << b.rows() << "x" << b.cols();
    }
    double largest = 0;
    for (Index j = 0; j < b.cols(); ++j)
      for (Index i = 0; i < b.rows(); ++i) {
        const auto v = static_cast<double>(b(i, j));
        if (std::isfinite(v)) largest = std::max(largest, std::abs(v));
      }
    const double allowed = atol_ + rtol_ * largest;
    for (Index j = 0; j < b.cols(); ++j)
      for (Index i = 0; i < b.rows(); ++i) {
        const auto u = static_cast<double>(a(i, j));
        const auto v = static_cast<double>(b(i, j));
        if (u == v || (std::isnan(u) && std::isnan(v))) continue;
        if (std::abs(u - v) <= allowed && std::isfinite(v)) continue;
        return testing::AssertionFailure()
               << "(" << i << ", " << j << "): " << u << ", expected " << v
               << ", off by " << std::abs(u - v) << ", allowed " << allowed;
      }
    return testing::AssertionSuccess();
  }

  testing::AssertionResult operator()(double a, double b) const {
    return (*this)(Vector<double>::Constant(1, a),
                   Vector<double>::Constant(1, b));
  }

 private:
  double rtol_, atol_;
};

}  // namespace physinv::test
