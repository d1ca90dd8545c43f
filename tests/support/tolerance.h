/// Comparisons: |a - b| <= atol + rtol max|b| over the whole array, because
/// entries near zero carry the rounding noise of the large ones.
#pragma once

#include <gtest/gtest.h>

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
    return compare(found.template cast<double>(),
                   wanted.template cast<double>());
  }
  testing::AssertionResult operator()(double a, double b) const;

 private:
  testing::AssertionResult compare(const Batch<double>& found,
                                   const Batch<double>& wanted) const;

  double rtol_, atol_;
};

}  // namespace physinv::test
