#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "suite/core/check.h"
#include "suite/core/simd/pack.h"
#include "suite/core/threads.h"
#include "tests/support/bits.h"
#include "tests/support/gradient_check.h"
#include "tests/support/physics.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

AnyProblem<double> equation(const KuramotoSivashinskyOptions& o = {}) {
  return AnyProblem<double>(problems::kuramoto_sivashinsky(o));
}

Samples<double> draw(Index n, const KuramotoSivashinskyOptions& o = {}) {
  return equation(o).sample(0, n, Rng::root("test/ks", 1));
}

template <class T>
struct Bench : Physics<AnyProblem<T>> {
  explicit Bench(const KuramotoSivashinskyOptions& o = {}, int count = 1)
      : Physics<AnyProblem<T>>(AnyProblem<T>(problems::kuramoto_sivashinsky(o)),
                               count) {}

  /// d/dx above d/du(0), at a y that has the bits of `forward`.
  Batch<T> pull(const Batch<T>& x, const Batch<T>& u0, const Batch<T>& y_bar) {
    const Index n = u0.rows();
    Batch<T> both(n + 2, x.cols());
    const Batch<T> y = this->linearize(x, u0);
    dynamic_cast<const StatePullback<T>&>(this->problem.problem())
        .pullback_state(
            this->tape, y_bar, both.topRows(2), both.bottomRows(n), this->work);
    EXPECT_TRUE(same_bits(Batch<T>(both.topRows(2)), this->pullback(y_bar)));
    EXPECT_TRUE(same_bits(y, this->forward(x, u0)));
    return both;
  }
};

Batch<double> simulate(const Batch<double>& x,
                       const Batch<double>& u0,
                       const KuramotoSivashinskyOptions& o = {}) {
  return Bench<double>(o).forward(x, u0);
}

template <class T>
class KuramotoSivashinskyIn : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(KuramotoSivashinskyIn, Scalars);

// ---- the equation ---------------------------------------------------------

TEST(KuramotoSivashinsky, WithoutAdvectionModesGrowAsTheyShould) {
  const KuramotoSivashinskyOptions o;
  const auto op = operators(o);
  Batch<double> x = Batch<double>::Zero(2, 5), u0(128, 5), end(128, 5);
  const Index modes[5] = {0, 1, 15, 22, 40};
  for (Index i = 0; i < 5; ++i)
    for (Index j = 0; j < 128; ++j) {
      const auto m = double(modes[i]);
      u0(j, i) = std::cos(2 * std::numbers::pi * m * (double(j) + 0.3) / 128);
      end(j, i) = u0(j, i) * std::exp(25 * op.linear(modes[i]));
    }
  EXPECT_NEAR(op.linear(22), 0, 1e-15);
  EXPECT_TRUE(Comparator(1e-12, 0)(simulate(x, u0), end));
}

TEST(KuramotoSivashinsky, WithoutAdvectionTheForcingIsLinear) {
  const auto s = draw(1);
  Batch<double> x = Batch<double>::Zero(2, 3);
  x.row(0) << 0, 1, -2.5;
  const Batch<double> y = simulate(x, s.given.replicate(1, 3));
  EXPECT_GT((y.col(1) - y.col(0)).norm(), 0.1);
  EXPECT_TRUE(
      Comparator(1e-12, 0)(y.col(2) - y.col(0), -2.5 * (y.col(1) - y.col(0))));
}

/// The smallest numbers take the general path, and vanish in every sum.
TYPED_TEST(KuramotoSivashinskyIn, WhatIsSkippedForZerosChangesNoValue) {
  using T = TypeParam;
  const T tiny = std::numeric_limits<T>::denorm_min();
  const auto s = draw(3).cast<T>();
  const Batch<T> y_bar = waves<T>(128, 3, 0.4);
  Bench<T> b;
  for (const Index zero : {0, 1}) {  // no forcing, no advection
    SCOPED_TRACE(zero);
    Batch<T> without = s.x, with = s.x;
    without.row(zero).setZero(), with.row(zero).setConstant(tiny);
    EXPECT_EQ(b.forward(without, s.given), b.forward(with, s.given));
    EXPECT_EQ(b.pull(without, s.given, y_bar), b.pull(with, s.given, y_bar));
  }
}

TYPED_TEST(KuramotoSivashinskyIn, TermsSkippedForZerosAreCounted) {
  using T = TypeParam;
  constexpr Index n = 2 * kLanes<T>;
  const auto s = draw(n).cast<T>();
  for (const int threads : {1, 3})
    for (const bool forced : {true, false})
      for (const bool advected : {true, false}) {
        Batch<T> x = s.x;
        if (!forced) x.row(0).setZero();
        if (!advected) x.row(1).setZero();
        const auto terms = [&](bool knows_advection) {
          return static_cast<std::uint64_t>(n * 100) *
                 (!forced + (knows_advection && !advected ? 2U : 0U));
        };
        Bench<T> b({}, threads);
        b.forward(x, s.given);
        EXPECT_EQ(b.work.counts[Counter::skipped_terms], terms(true));
        b.work.counts = {};
        b.jacobian(x, s.given);
        EXPECT_EQ(b.work.counts[Counter::skipped_terms], terms(false));
        for (const double budget : {0.0, 1e12}) {
          Bench<T> kept({.tape_budget = budget}, threads);
          Batch<T> y(128, n);
          kept.problem.linearize(x, s.given, y, kept.tape);
          EXPECT_EQ(kept.tape.counts[Counter::skipped_terms], terms(false));
        }
      }
  // One that has the term makes its register compute it.
  Batch<T> x = s.x;
  x.setZero(), x.col(0).setOnes();
  Bench<T> b;
  b.forward(x, s.given);
  EXPECT_EQ(b.work.counts[Counter::skipped_terms],
            static_cast<std::uint64_t>(n / 2 * 100 * 3));
}

TEST(KuramotoSivashinsky, ChangingEverySignChangesNothingElse) {
  const auto s = draw(9);
  EXPECT_EQ(simulate(-s.x, -s.given), -s.y);
}

TEST(KuramotoSivashinsky, WithoutForcingMirrorsAreSolutionsAndMeansStay) {
  auto s = draw(9);
  s.x.row(0).setZero();
  s.given.row(3).array() += 5;
  const Batch<double> y = simulate(s.x, s.given);
  const Batch<double> mirrored = -s.given.colwise().reverse();
  EXPECT_TRUE(
      Comparator(1e-9, 0)(simulate(s.x, mirrored), -y.colwise().reverse()));
  EXPECT_TRUE(
      Comparator(1e-13, 1e-13)(y.colwise().mean(), s.given.colwise().mean()));
}

TEST(KuramotoSivashinsky, ConvergesWithTheSquareOfTheStep) {
  const auto s = draw(4);
  const auto at = [&](Index steps) {
    return simulate(
        s.x, s.given, {.time_step = 4.0 / double(steps), .steps = steps});
  };
  const Batch<double> exact = at(1024);
  const double coarse = (at(32) - exact).norm(), fine = (at(64) - exact).norm();
  EXPECT_NEAR(coarse / fine, 4, 0.5);
}

TEST(KuramotoSivashinsky, ConvergesWithTheGrid) {
  // Without the forcing, whose samples jump at the end of the box.
  const auto on = [](Index cells) {
    Batch<double> u0(cells, 1);
    for (Index j = 0; j < cells; ++j)
      u0(j, 0) = std::sin(2 * std::numbers::pi * (double(j) + 0.5) /
                          double(cells) * 3);
    return simulate(Eigen::Vector2d(0, 1), u0, {.cells = cells});
  };
  const Batch<double> coarse = on(256), fine = on(512);
  for (const Index m : {1, 3, 6, 12}) {
    const auto coefficient = [m](const Batch<double>& u) {
      std::complex<double> sum;
      for (Index j = 0; j < u.rows(); ++j)
        sum += std::polar(u(j, 0) / double(u.rows()),
                          -2 * std::numbers::pi * double(m) *
                              (double(j) + 0.5) / double(u.rows()));
      return sum;
    };
    EXPECT_NEAR(std::abs(coefficient(coarse) - coefficient(fine)), 0, 1e-9);
  }
}

TYPED_TEST(KuramotoSivashinskyIn, TrajectoriesPassThroughEveryState) {
  using T = TypeParam;
  const auto s = draw(1).cast<T>();
  const Batch<T> path =
      kuramoto_sivashinsky_trajectory<T>({}, s.x.col(0), s.given.col(0));
  ASSERT_EQ(path.cols(), 101);
  EXPECT_TRUE(same_bits(Batch<T>(path.leftCols(1)), s.given));
  for (const Index k : {1, 2, 37, 100}) {
    Bench<T> b({.steps = k});
    EXPECT_TRUE(same_bits(Batch<T>(path.col(k)), b.forward(s.x, s.given)));
  }
}

// ---- derivatives ----------------------------------------------------------

TEST(KuramotoSivashinsky, GradientsAgreeWithCentralDifferences) {
  for (const double alpha : {0.0, 1.1}) {
    auto s = draw(3);
    s.x.row(0).setConstant(alpha);
    s.x(1, 2) = 0;
    const Batch<double> y_bar = waves<double>(128, 3, 0.4);
    Bench<double> b;
    const Batch<double> pulled = b.pull(s.x, s.given, y_bar);
    for (Index i = 0; i < 3; ++i) {
      Vector<double> both(130);
      both << s.x.col(i), s.given.col(i);
      const auto value = [&](const Vector<double>& at) {
        return y_bar.col(i).dot(b.forward(at.head(2), at.tail(128)).col(0));
      };
      EXPECT_TRUE(Comparator(1e-6, 1e-7)(pulled.col(i),
                                         difference_gradient(value, both)));
    }
  }
}

TYPED_TEST(KuramotoSivashinskyIn, TangentRunsAndAdjointAgree) {
  using T = TypeParam;
  const auto s = draw(21).cast<T>();
  const Batch<T> y_bar = waves<T>(128, 21, 2.4);
  Bench<T> b;
  const Batch<T> pulled = b.pull(s.x, s.given, y_bar);
  const Batch<T> j = b.jacobian(s.x, s.given);
  for (Index i = 0; i < 21; ++i) {
    const Eigen::Map<const Batch<T>> ji(j.col(i).data(), 128, 2);
    const double scale = double(ji.cwiseAbs().maxCoeff());
    EXPECT_TRUE(Comparator(0, Tolerance<T>::relative * scale)(
        pulled.col(i).head(2), ji.transpose() * y_bar.col(i)));
  }
}

TYPED_TEST(KuramotoSivashinskyIn, CheckpointsHaveTheBitsOfAFullTape) {
  using T = TypeParam;
  for (const Index steps : {1, 2, 17, 100}) {
    SCOPED_TRACE(steps);
    const auto s = draw(11).cast<T>();
    const Batch<T> y_bar = waves<T>(128, 11, 1.4);
    Bench<T> full({.steps = steps, .tape_budget = 1e12});
    Bench<T> small({.steps = steps, .tape_budget = 0});
    EXPECT_TRUE(same_bits(full.pull(s.x, s.given, y_bar),
                          small.pull(s.x, s.given, y_bar)));
    if (steps == 100) {
      EXPECT_LT(5 * small.tape.bytes(), full.tape.bytes());
    }
  }
}

TYPED_TEST(KuramotoSivashinskyIn, ZeroCotangentsNeedNoWayBack) {
  using T = TypeParam;
  const auto s = draw(2).cast<T>();
  Bench<T> b;
  const Batch<T> zero = Batch<T>::Zero(128, 2);
  EXPECT_EQ(b.pull(s.x, s.given, zero), Batch<T>::Zero(130, 2));
  EXPECT_EQ(b.work.counts[Counter::skipped_vjp], 4U);  // pulled twice
  // Next to another the way back is one for both, and the value is the same.
  Batch<T> one = zero;
  one(5, 1) = 1;
  const Batch<T> pulled = b.pull(s.x, s.given, one);
  EXPECT_EQ(pulled.col(0), Vector<T>::Zero(130));
  EXPECT_GT(pulled.col(1).norm(), 0);
  EXPECT_EQ(b.work.counts[Counter::skipped_vjp], 6U);
}

// ---- batches --------------------------------------------------------------

TYPED_TEST(KuramotoSivashinskyIn, BitsDependNeitherOnBatchNorOnThreads) {
  using T = TypeParam;
  constexpr Index n = 21;
  const auto s = draw(n).cast<T>();
  const Batch<T> y_bar = waves<T>(128, n, 0.4);
  for (const double budget : {0.0, 1e12}) {
    Bench<T> b({.tape_budget = budget});
    const Batch<T> pulled = b.pull(s.x, s.given, y_bar);
    const Batch<T> j = b.jacobian(s.x, s.given);
    Bench<T> threaded({.tape_budget = budget}, 3);
    EXPECT_TRUE(same_bits(threaded.pull(s.x, s.given, y_bar), pulled));
    EXPECT_TRUE(same_bits(threaded.jacobian(s.x, s.given), j));
    for (const Index size : {1, 2, 3, 5}) {
      for (Index first = 0; first + size <= n; first += size) {
        const auto part = [&](const Batch<T>& all) {
          return Batch<T>(all.middleCols(first, size).rowwise().reverse());
        };
        EXPECT_TRUE(same_bits(b.pull(part(s.x), part(s.given), part(y_bar)),
                              part(pulled)));
        EXPECT_TRUE(same_bits(b.jacobian(part(s.x), part(s.given)), part(j)));
      }
    }
  }
}

TYPED_TEST(KuramotoSivashinskyIn, DivergedSamplesDisturbNoOther) {
  using T = TypeParam;
  constexpr Index n = 21;
  const T nan = std::numeric_limits<T>::quiet_NaN();
  const auto s = draw(n).cast<T>();
  const Batch<T> y_bar = waves<T>(128, n, 0.4);
  for (const double budget : {0.0, 1e12}) {
    Bench<T> b({.tape_budget = budget});
    Batch<T> x = s.x, u0 = s.given;
    Batch<T> y = b.forward(x, u0), pulled = b.pull(x, u0, y_bar);
    Batch<T> j = b.jacobian(x, u0);
    x(1, 2) = 200, x(0, 7) = std::numeric_limits<T>::max(), x(0, 8) = nan;
    u0(5, 20) = std::numeric_limits<T>::infinity();
    for (const Index i : {2, 7, 8, 20}) {
      y.col(i).setConstant(nan);
      pulled.col(i).setConstant(nan);
      j.col(i).setConstant(nan);
    }
    EXPECT_TRUE(same_bits(b.forward(x, u0), y));
    EXPECT_TRUE(same_bits(b.pull(x, u0, y_bar), pulled));
    EXPECT_TRUE(same_bits(b.jacobian(x, u0), j));
    EXPECT_TRUE(kuramoto_sivashinsky_trajectory<T>({}, x.col(2), u0.col(2))
                    .rightCols(50)
                    .array()
                    .isNaN()
                    .all());
  }
}

/// A register of samples ends with its last one.
TEST(KuramotoSivashinsky, DivergedSamplesAreNotSteppedOn) {
  constexpr int n = 3 * kLanes<double>;
  const auto s = draw(n);
  Batch<double> x = s.x, y(128, n), x_bar(2, n);
  x.row(1).setConstant(1e4);
  const auto problem = equation();
  Workspace work;
  Tape tape;
  problem.forward(x, s.given, y, work);
  EXPECT_TRUE(y.array().isNaN().all());
  EXPECT_GT(work.counts[Counter::skipped_steps], n * 80U);
  EXPECT_LT(work.counts[Counter::skipped_steps], n * 100U);
  problem.linearize(x, s.given, y, tape);
  const auto skipped = work.counts[Counter::skipped_steps];
  EXPECT_EQ(tape.counts[Counter::skipped_steps], skipped);
  problem.pullback(tape, s.y, x_bar, work);
  EXPECT_TRUE(x_bar.array().isNaN().all());
  EXPECT_EQ(work.counts[Counter::skipped_vjp], static_cast<std::uint64_t>(n));
  // The register of one that lives continues, the others do not.
  x(1, 1) = 1;
  work.counts = {};
  problem.forward(x, s.given, y, work);
  EXPECT_GT(work.counts[Counter::skipped_steps], n / 3 * 2 * 80U);
  EXPECT_LT(work.counts[Counter::skipped_steps], n / 3 * 2 * 100U);
  EXPECT_TRUE(y.col(1).allFinite());
  EXPECT_TRUE(y.col(0).array().isNaN().all());
}

TYPED_TEST(KuramotoSivashinskyIn, ReadsAndWritesBlocksAndEmptyBatches) {
  using T = TypeParam;
  const auto s = draw(6).cast<T>();
  Batch<T> big = Batch<T>::Zero(140, 12);
  big.block(1, 3, 2, 6) = s.x, big.block(5, 3, 128, 6) = s.given;
  Batch<T> out = Batch<T>::Constant(131, 9, T(-3));
  Bench<T> b;
  b.problem.forward(big.block(1, 3, 2, 6),
                    big.block(5, 3, 128, 6),
                    out.block(1, 2, 128, 6),
                    b.work);
  EXPECT_TRUE(
      same_bits(Batch<T>(out.block(1, 2, 128, 6)), b.forward(s.x, s.given)));
  EXPECT_EQ((out.array() == T(-3)).count(), 131 * 9 - 128 * 6);
  const Batch<T> none(2, 0), states(128, 0);
  EXPECT_EQ(b.pull(none, states, states).cols(), 0);
}

// ---- data -----------------------------------------------------------------

TEST(KuramotoSivashinsky, SamplesHaveTheirDistribution) {
  constexpr Index n = 3000;
  const KuramotoSivashinskyOptions o{.steps = 1};
  const auto s = draw(n, o);
  EXPECT_GE(s.x.minCoeff(), 0.75);
  EXPECT_LT(s.x.maxCoeff(), 1.25);
  for (Index j = 0; j < 2; ++j) {
    EXPECT_NEAR(s.x.row(j).mean(), 1, 0.01);
    EXPECT_NEAR((s.x.row(j).array() - 1).square().mean(), 0.25 / 12, 0.002);
  }
  Vector<double> power = Vector<double>::Zero(8);
  for (Index i = 0; i < n; ++i) {
    EXPECT_NEAR(s.given.col(i).mean(), 0, 1e-14);
    EXPECT_NEAR(s.given.col(i).squaredNorm() / 128, 1, 1e-12);
    for (Index m = 1; m < 8; ++m) {
      std::complex<double> sum;
      for (Index j = 0; j < 128; ++j)
        sum += std::polar(s.given(j, i),
                          2 * std::numbers::pi * double(j * m) / 128);
      power(m) += std::norm(sum);
    }
  }
  // Amplitudes fall as 1 / m^2. A sample's deviation depends on its modes 1 and
  // 2 and divides them all, so only the others are compared.
  for (Index m = 4; m < 8; ++m)
    EXPECT_NEAR(power(m) / power(3) * std::pow(double(m) / 3, 4), 1, 0.15) << m;
}

TEST(KuramotoSivashinsky, SamplesAreWhatTheEquationGives) {
  const auto s = draw(5);
  EXPECT_TRUE(same_bits(simulate(s.x, s.given), s.y));
  EXPECT_TRUE(s.y.allFinite());
}

TEST(KuramotoSivashinsky, ChecksItsContract) {
  const auto problem = equation();
  Workspace work;
  Batch<double> x(2, 3), u0(128, 3), y(128, 3);
  EXPECT_THROW(problem.forward(x.topRows(1), u0, y, work), ContractError);
  EXPECT_THROW(problem.forward(x, u0.leftCols(2), y, work), ContractError);
  EXPECT_THROW(problem.forward(x, u0, y.topRows(64), work), ContractError);
  EXPECT_THROW(equation({.cells = 100}), ContractError);
  EXPECT_THROW(equation({.cells = 8}), ContractError);
  EXPECT_THROW(equation({.steps = 0}), ContractError);
  EXPECT_THROW(equation({.prior_low = 2}), ContractError);
}

}  // namespace
}  // namespace physinv::test
