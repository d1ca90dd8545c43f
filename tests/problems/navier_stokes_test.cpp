#include "problems/navier_stokes/navier_stokes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "suite/core/any_problem.h"
#include "tests/support/bits.h"
#include "tests/support/gradient_check.h"
#include "tests/support/physics.h"

namespace physinv::test {
namespace {

/// A quarter of the scene's cells and steps.
NavierStokesOptions small(double tape_budget = 1e9) {
  return {.cells = 32,
          .end_time = 14,
          .steps = 7,
          .obstacles = {{6, 11, 12, 14}, {13, 18, 19, 22}},
          .tape_budget = tape_budget};
}

Samples<double> draw(Index n) {
  return AnyProblem<double>(problems::navier_stokes(small()))
      .sample(0, n, Rng::root("test/navier_stokes", 1));
}

template <class T>
auto physics(int threads = 1, double budget = 1e9) {
  return Physics(AnyProblem<T>(problems::navier_stokes(small(budget))),
                 threads);
}

template <class T>
class NavierStokesIn : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(NavierStokesIn, Scalars);

TEST(NavierStokes, SamplesAreWhatTheyShouldBe) {
  const auto s = draw(12);
  const auto few = draw(3);
  EXPECT_TRUE(same_bits(Batch<double>(s.x.leftCols(3)), few.x));
  EXPECT_TRUE(same_bits(Batch<double>(s.y.leftCols(3)), few.y));
  EXPECT_TRUE(same_bits(Batch<double>(s.given.leftCols(3)), few.given));
  EXPECT_LE(s.x.row(0).cwiseAbs().maxCoeff(), std::atanh(0.7));
  EXPECT_LE(s.x.bottomRows(2).cwiseAbs().maxCoeff(), 1);
  const auto all =
      AnyProblem<double>(problems::navier_stokes(small()))
          .sample_labelled(0, 12, Rng::root("test/navier_stokes", 1));
  EXPECT_NEAR(std::sqrt(all.given.squaredNorm() / double(all.given.size())),
              0.5,
              1e-12);
  EXPECT_TRUE(same_bits(all.y, s.y));
  EXPECT_TRUE(same_bits(physics<double>().forward(all.x, all.given), s.y));
  // The flow below is hidden: the truth does not fit.
  EXPECT_EQ((all.given - s.given).cwiseProduct(s.given).norm(), 0);
  const Batch<double> y = physics<double>().forward(s.x, s.given);
  EXPECT_GT((y - s.y).colwise().norm().minCoeff(), 0.1);
}

TYPED_TEST(NavierStokesIn, PullbackIsTheJacobiansTranspose) {
  using T = TypeParam;
  const auto s = draw(5).template cast<T>();
  auto bench = physics<T>();
  const Batch<T> bar = s.y.reverse();
  const Batch<T> x_bar = bench.gradient(s.x, s.given, bar);
  const Batch<double> j = bench.jacobian(s.x, s.given).template cast<double>();
  for (Index i = 0; i < 5; ++i) {
    const Vector<double> expected =
        j.col(i).reshaped(s.y.rows(), 3).transpose() *
        bar.col(i).template cast<double>();
    const double off =
        (x_bar.col(i).template cast<double>() - expected).cwiseAbs().maxCoeff();
    EXPECT_LE(off,
              (sizeof(T) == 8 ? 1e-12 : 2e-4) * expected.cwiseAbs().maxCoeff());
  }
}

TEST(NavierStokes, JacobianIsTheDerivative) {
  const auto s = draw(1);
  auto bench = physics<double>();
  const Batch<double> j = bench.jacobian(s.x, s.given).reshaped(s.y.rows(), 3);
  const Batch<double> expected = difference_jacobian(
      [&](const Vector<double>& x) -> Vector<double> {
        return bench.forward(x, s.given).col(0);
      },
      s.x.col(0),
      1e-8);
  EXPECT_LE((j - expected).norm(), 1e-5 * expected.norm());
}

TEST(NavierStokes, BoundsAreOtherCoordinatesOfTheSameBlast) {
  const auto ours = draw(2);
  for (const Index bounded : {0, 2, 3}) {
    NavierStokesOptions o = small();
    o.bounded = bounded;
    Physics bench{AnyProblem<double>(problems::navier_stokes(o))};
    const auto s =
        bench.problem.sample(0, 2, Rng::root("test/navier_stokes", 1));
    EXPECT_TRUE(same_bits(s.given, ours.given));
    EXPECT_LE((s.y - ours.y).norm(), 1e-9 * ours.y.norm());
    const auto t = [](const Batch<double>& x, Index of) {
      Batch<double> out = x;
      out.topRows(of) = x.topRows(of).array().tanh();
      return out;
    };
    EXPECT_LE((t(s.x, bounded) - t(ours.x, 1)).cwiseAbs().maxCoeff(), 1e-12);
    const Batch<double> x = s.x.col(0), given = s.given.col(0);
    const Batch<double> j = bench.jacobian(x, given).reshaped(s.y.rows(), 3);
    const Batch<double> expected = difference_jacobian(
        [&](const Vector<double>& at) -> Vector<double> {
          return bench.forward(at, given).col(0);
        },
        x.col(0),
        1e-8);
    EXPECT_LE((j - expected).norm(), 1e-5 * expected.norm());
    const Batch<double> bar = s.y.col(0);
    EXPECT_LE((bench.gradient(x, given, bar) - j.transpose() * bar).norm(),
              1e-12 * (j.transpose() * bar).norm());
  }
}

TYPED_TEST(NavierStokesIn, BitsDependOnNothingElse) {
  using T = TypeParam;
  const auto s = draw(11).template cast<T>();
  auto one = physics<T>(), two = physics<T>(2), again = physics<T>(2, 0);
  const Batch<T> y = one.forward(s.x, s.given);
  const Batch<T> x_bar = one.gradient(s.x, s.given, s.y);
  EXPECT_TRUE(same_bits(two.gradient(s.x, s.given, s.y), x_bar));
  EXPECT_TRUE(same_bits(again.gradient(s.x, s.given, s.y), x_bar));
  const std::vector<Index> some{10, 3, 4};
  const Batch<T> x = s.x(Eigen::all, some), given = s.given(Eigen::all, some),
                 bar = s.y(Eigen::all, some);
  EXPECT_TRUE(same_bits(one.forward(x, given), Batch<T>(y(Eigen::all, some))));
  EXPECT_TRUE(same_bits(one.gradient(x, given, bar),
                        Batch<T>(x_bar(Eigen::all, some))));
  const Batch<T> j = two.jacobian(s.x, s.given);
  EXPECT_TRUE(same_bits(one.jacobian(x, given), Batch<T>(j(Eigen::all, some))));
}

TYPED_TEST(NavierStokesIn, WhatIsLostStaysInItsColumn) {
  using T = TypeParam;
  auto s = draw(6).template cast<T>();
  auto bench = physics<T>();
  const Batch<T> y = bench.forward(s.x, s.given);
  const Batch<T> x_bar = bench.gradient(s.x, s.given, s.y);
  s.x(1, 2) = std::numeric_limits<T>::quiet_NaN();
  s.x(0, 3) = std::numeric_limits<T>::infinity();
  s.given(40, 4) = T(1e30);
  const Batch<T> y2 = bench.forward(s.x, s.given);
  const Batch<T> x_bar2 = bench.gradient(s.x, s.given, s.y);
  const Batch<T> j = bench.jacobian(s.x, s.given);
  for (Index i = 0; i < 6; ++i) {
    const bool lost = i >= 2 && i <= 4;
    EXPECT_EQ(y2.col(i).array().isNaN().all(), lost);
    EXPECT_EQ(x_bar2.col(i).array().isNaN().all(), lost);
    EXPECT_EQ(j.col(i).array().isNaN().all(), lost);
    if (lost) continue;
    EXPECT_TRUE(same_bits(Batch<T>(y.col(i)), Batch<T>(y2.col(i))));
    EXPECT_TRUE(same_bits(Batch<T>(x_bar.col(i)), Batch<T>(x_bar2.col(i))));
  }
  // A blast far too strong is still a number.
  s.x.col(0) << T(-40), T(1e5), T(-1e5);
  EXPECT_TRUE(bench.forward(s.x, s.given).col(0).allFinite());
  EXPECT_TRUE(bench.gradient(s.x, s.given, s.y).col(0).allFinite());
}

}  // namespace
}  // namespace physinv::test
