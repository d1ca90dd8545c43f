// Conjugate gradients of Poisson's equation at sizes whose squares leave the
// range.
#include "problems/poisson/poisson.h"

#include <gtest/gtest.h>

#include <cmath>

#include "suite/core/any_problem.h"
#include "tests/support/bits.h"

namespace physinv {
namespace {

constexpr Index kRows = 8, kColumns = 6;

template <class T>
Batch<T> sources() {
  return Batch<T>::NullaryExpr(kRows * kColumns, 3, [](Index i, Index j) {
    return static_cast<T>(std::sin(1.7 * double(i) + double(j * j) + 0.2));
  });
}

template <class T>
Batch<T> potential(const Batch<T>& x, double relative) {
  const AnyProblem<T> problem(problems::poisson(
      {.rows = kRows, .columns = kColumns, .relative = relative}));
  Batch<T> y(x.rows(), x.cols());
  Workspace work;
  problem.forward(x, Batch<T>(0, x.cols()), y, work);
  return y;
}

/// |L y - x| <= relative |x|, both in units of `size`.
void expect_solved(const Batch<double>& x, double size, double relative) {
  const Batch<double> y = potential<double>(x, relative);
  for (Index i = 0; i < x.cols(); ++i) {
    const Vector<double> right = x.col(i) / size;
    const Batch<double> field = (y.col(i) / size).reshaped(kColumns, kRows);
    const double rest = (laplacian(field).reshaped() - right).norm();
    EXPECT_LE(rest, 1.001 * relative * right.norm()) << size;
    EXPECT_GT(rest, 0) << "solved to some tolerance, not exactly";
  }
}

TEST(Poisson, ToleranceIsRelativeAtAnySize) {
  for (const double size : {1.0, 1e-160, 1e-200, 1e-300, 1e150, 1e200, 1e300})
    for (const double relative : {1e-2, 1e-5})
      expect_solved(size * sources<double>(), size, relative);
}

TEST(Poisson, PowersOfTwoChangeNoBit) {
  const Batch<double> x = sources<double>(), y = potential<double>(x, 1e-5);
  for (const int e : {-900, -540, -200, 200, 540, 900}) {
    const double size = std::ldexp(1.0, e);
    EXPECT_TRUE(test::same_bits(potential<double>(size * x, 1e-5),
                                Batch<double>(size * y)))
        << e;
  }
}

TEST(Poisson, WhatIsNotFiniteAndWhatIsZero) {
  Batch<double> x = 1e-160 * sources<double>();
  x(4, 0) = std::nan("");
  x(4, 1) = INFINITY;
  x.col(2).setZero();
  const Batch<double> y = potential<double>(x, 1e-5);
  EXPECT_TRUE(y.col(0).array().isNaN().all());
  EXPECT_TRUE(y.col(1).array().isNaN().all());
  EXPECT_TRUE(y.col(2).isZero(0));
}

}  // namespace
}  // namespace physinv
