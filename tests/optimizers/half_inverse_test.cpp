// The choice among the paths, and what they do with unusual input.
#include "optimizers/half_inverse/half_inverse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "suite/core/check.h"
#include "tests/optimizers/half_inverse_truth.h"
#include "tests/support/bits.h"

namespace physinv::hig {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(HalfInverse, EdgesOfTheInput) {
  Batch<double> gram = graded(20, 30, 3, 40);
  gram = (gram * gram.transpose()).eval();
  Vector<double> g = noise(20, 1, 41), v(20);
  SpectralPower spectral;
  EXPECT_EQ(spectral.factor(gram, Vector<double>::Zero(20)), Ending::zero);
  v.setConstant(3);
  EXPECT_EQ(spectral.apply({}, v).ending, Ending::zero);
  EXPECT_TRUE(v.isZero(0));
  EXPECT_EQ(spectral.factor(Batch<double>::Zero(20, 20), g), Ending::zero);
  for (const double bad : {kNan, HUGE_VAL, -HUGE_VAL}) {
    Batch<double> broken = gram;
    broken(11, 4) = bad;
    EXPECT_EQ(spectral.factor(broken, g), Ending::nonfinite);
    EXPECT_EQ(spectral.apply({}, v).ending, Ending::nonfinite);
    EXPECT_TRUE(v.isZero(0));
    Vector<double> h = g;
    h(3) = bad;
    EXPECT_EQ(spectral.factor(gram, h), Ending::nonfinite);
    ExplicitPower full;
    EXPECT_EQ(full.factor(broken, g), Ending::nonfinite);
  }
  Batch<double> upper = gram;  // only the lower triangle is read
  upper.triangularView<Eigen::StrictlyUpper>().setConstant(kNan);
  ASSERT_EQ(spectral.factor(upper, g), Ending::ok);
  EXPECT_EQ(spectral.apply({}, v).ending, Ending::ok);
  EXPECT_EQ(spectral.apply({.tau = 2}, v).ending, Ending::zero);
  EXPECT_TRUE(v.isZero(0));
  // tau = 0 keeps everything that is above 0.
  EXPECT_EQ(spectral.apply({.tau = 0}, v).kept, 20);
  EXPECT_THROW(spectral.apply({.kappa = -1.5}, v), ContractError);
}

TEST(HalfInverse, GradientsAtExtremesOfScale) {
  const Batch<double> j = graded(30, 40, 2, 50);
  const Batch<double> gram = j * j.transpose();
  const Vector<double> g = noise(30, 1, 51);
  SpectralPower spectral;
  Vector<double> v(30), w(30);
  ASSERT_EQ(spectral.factor(gram, g), Ending::ok);
  spectral.apply({}, v);
  for (const double scale : {1e-200, 1e200}) {
    ASSERT_EQ(spectral.factor(gram, scale * g), Ending::ok);
    spectral.apply({}, w);
    EXPECT_LT((w / scale - v).norm(), 1e-9 * v.norm());
  }
}

TEST(HalfInverse, JacobiansAtExtremesOfScale) {
  const Vector<double> g = noise(12, 1, 52);
  ExplicitPower one, other;
  for (const Batch<double>& j : {graded(12, 20, 3, 51), graded(12, 7, 3, 51)})
    for (const Power power : {Power{.kappa = -0.5, .tau = 1e-2},
                              Power{.kappa = -1, .tau = 1e-2},
                              Power{.kappa = 0.25, .tau = 1e-6, .beta = -0.5},
                              Power{.kappa = 1, .tau = 0}}) {
      Vector<double> update(j.cols()), far(j.cols());
      ASSERT_EQ(one.factor(j, g), Ending::ok);
      const PowerReport expected = one.apply(power, update);
      for (const double size : {1e-300, 1e-200, 1e-100, 1e100, 1e200, 1e300}) {
        ASSERT_EQ(other.factor(size * j, g), Ending::ok);
        const PowerReport report = other.apply(power, far);
        const double factor = std::pow(size, power.kappa + power.beta);
        if (!std::isfinite(factor * update.norm()) ||
            factor * update.norm() < 1e-290)
          continue;
        const double near = 1e-11;
        EXPECT_LE((far / factor - update).norm(), near * update.norm()) << size;
        EXPECT_EQ(report.kept, expected.kept);
        EXPECT_NEAR(report.s_max / size, expected.s_max, near * expected.s_max);
        EXPECT_NEAR(report.norm / factor, expected.norm, near * expected.norm);
        EXPECT_NEAR(report.cut / size, expected.cut, near * expected.cut);
      }
    }
  // An absolute cut is one in units of J.
  const Batch<double> j = graded(12, 20, 3, 51);
  Vector<double> update(20), far(20);
  one.factor(j, g), other.factor(1e-200 * j, g);
  const Index kept =
      one.apply({.kappa = -1, .tau = 3e-2, .absolute = true}, update).kept;
  EXPECT_GT(kept, 0);
  EXPECT_LT(kept, 12);
  EXPECT_EQ(
      other.apply({.kappa = -1, .tau = 3e-202, .absolute = true}, far).kept,
      kept);
}

TEST(HalfInverse, OneByOne) {
  SpectralPower spectral;
  Vector<double> v(1);
  ASSERT_EQ(spectral.factor(Batch<double>::Constant(1, 1, 9),
                            Vector<double>::Constant(1, -2)),
            Ending::ok);
  const PowerReport r = spectral.apply({.kappa = -1, .beta = 1}, v);
  EXPECT_EQ(r.kept, 1);
  EXPECT_DOUBLE_EQ(r.s_max, 3);
  EXPECT_DOUBLE_EQ(v(0), -2.0 / 9 * 3);
}

TEST(HalfInverse, SettingsShareWhatIsFactored) {
  const Index m = 80;
  const Batch<double> j = graded(m, 100, 9, 60);
  const Batch<double> gram = j * j.transpose();
  const Vector<double> g = noise(m, 1, 61);
  const std::vector<Power> all = {{.kappa = -0.5, .tau = 1e-3},
                                  {.kappa = -1, .tau = 1e-6},
                                  {.kappa = -1, .tau = 1e-12},
                                  {.kappa = 0, .tau = 1e-2, .beta = 0.5}};
  Batch<double> together(100, 4), alone(100, 1);
  HalfInverse many;
  const auto reports = many(gram, g, pullback_of(j), all, together);
  const std::vector<HalfInverseReport> kept(reports.begin(), reports.end());
  std::vector<Path> paths;
  for (std::size_t i = 0; i < all.size(); ++i) {
    HalfInverse one;
    const auto report =
        one(gram, g, pullback_of(j), std::span(&all[i], 1), alone);
    EXPECT_EQ(report[0].path, kept[i].path);
    EXPECT_EQ(report[0].error, kept[i].error);
    EXPECT_TRUE(alone.col(0) == together.col(static_cast<Index>(i))) << i;
    paths.push_back(kept[i].path);
  }
  EXPECT_EQ(paths[0], Path::gram);
  EXPECT_NE(paths[2], Path::gram);
  EXPECT_GE(many.counts().abandoned[1], 1);
}

TEST(HalfInverse, FallsBackUntilProvenAndCounts) {
  const Index m = 60, p = 90;
  const Batch<double> j = graded(m, p, 8, 70);
  const Vector<double> g = noise(m, 1, 71);
  const Definition truth(j, g);
  const Power power{.kappa = -0.5, .tau = 1e-7};
  Batch<double> update(p, 1);
  for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-30}) {
    HalfInverse solver({.tolerance = tolerance});
    const auto report = solver(
        j * j.transpose(), g, pullback_of(j), std::span(&power, 1), update)[0];
    const Vector<double> expected = truth.update(power);
    EXPECT_LE((update - expected).norm() / expected.norm(),
              std::max(report.error, 1e-12));
    EXPECT_EQ(report.proven, report.error <= tolerance);
    EXPECT_EQ(solver.counts().unproven, report.proven ? 0 : 1);
    EXPECT_EQ(report.proven, tolerance > 1e-20);
    const auto abandoned = solver.counts().abandoned;
    EXPECT_EQ(abandoned[1], report.path == Path::gram ? 0 : 1);
    EXPECT_EQ(abandoned[2], report.path == Path::explicit_jacobian ? 1 : 0);
  }
}

// A proven path makes the one behind it needless: that would end within the two
// estimates.
TEST(HalfInverse, LevelsSparedAndGivenUpAreCounted) {
  const Index m = 60, p = 90;
  const Batch<double> j = graded(m, p, 8, 70);
  const Vector<double> g = noise(m, 1, 71);
  const auto run = [&](double tau,
                       double tolerance,
                       Index largest,
                       Batch<double>& update) {
    const Power power{.kappa = -0.5, .tau = tau};
    HalfInverse solver({.tolerance = tolerance, .largest_jacobian = largest});
    return solver(
        j * j.transpose(), g, pullback_of(j), std::span(&power, 1), update)[0];
  };
  Batch<double> update(p, 1), exact(p, 1);
  const auto expect = [&](double tau, Path path, Index abandoned) {
    const auto report = run(tau, 1e-2, m * p, update);
    EXPECT_EQ(report.path, path);
    EXPECT_EQ(report.abandoned, abandoned);
    EXPECT_TRUE(report.spared);
    const auto last = run(tau, 1e-30, m * p, exact);
    EXPECT_EQ(last.path, Path::explicit_jacobian);
    EXPECT_GE(last.abandoned, 2);
    EXPECT_FALSE(last.spared);
    EXPECT_LE((update - exact).norm(),
              (report.error + last.error + 1e-12) * exact.norm());
  };
  expect(1e-3, Path::gram, 0);
  expect(1e-7, Path::two_level, 1);
  // The last path that there is spares nothing.
  const auto last = run(1e-7, 1e-2, m * p - 1, update);
  EXPECT_EQ(last.path, Path::two_level);
  EXPECT_TRUE(last.proven);
  EXPECT_FALSE(last.spared);
  // Nothing is begun for zeros.
  HalfInverse solver;
  const auto zero = solver(j * j.transpose(),
                           Vector<double>::Zero(m),
                           pullback_of(j),
                           std::vector<Power>{{.kappa = -1}},
                           update)[0];
  EXPECT_EQ(zero.ending, Ending::zero);
  EXPECT_EQ(zero.abandoned, 0);
  EXPECT_FALSE(zero.spared);
}

TEST(HalfInverse, WaysBackThatAreGivenUpChangeNoBit) {
  const Index m = 60, p = 90;
  const Batch<double> j = graded(m, p, 8, 70);
  const Batch<double> gram = j * j.transpose();
  const Vector<double> g = noise(m, 1, 71);
  SpectralPower spectral;
  TwoLevelPower two(spectral);
  Vector<double> with(m), without(m);
  Index fell = 0;
  for (const double kappa : {-0.5, -1.0, 0.25})
    for (double tau = 1e-2; tau > 1e-9; tau /= 3) {
      const Power power{.kappa = kappa, .tau = tau};
      ASSERT_EQ(spectral.factor(gram, g), Ending::ok);
      const double error = spectral.apply(power, without).error;
      EXPECT_EQ(spectral.apply(power, with, 1e-5).error, error);
      if (error <= 1e-5) {
        EXPECT_TRUE(test::same_bits(with, without));
      } else {
        EXPECT_TRUE(with.isZero(0));
        HalfInverse solver({.tolerance = 1e-5, .shortcut = false});
        Batch<double> update(p, 1), pulled(p, 1);
        const auto report =
            solver(gram, g, pullback_of(j), std::span(&power, 1), update)[0];
        two.open();
        two.apply(power, 1e-5, p, pullback_of(j), without);
        pullback_of(j)(without, pulled);
        if (report.path == Path::two_level) {
          ++fell;
          EXPECT_TRUE(test::same_bits(update, pulled));
        }
      }
    }
  EXPECT_GT(fell, 0);
}

// A cut next to a value that only the refined spectrum shows to be so near.
TEST(HalfInverse, RangesThatAreGivenUpAreCountedAndLeaveNothing) {
  const Index m = 60, p = 90;
  const Batch<double> j = graded(m, p, 8, 70);
  const Vector<double> g = noise(m, 1, 71);
  const Definition truth(j, g);
  SpectralPower spectral;
  TwoLevelPower two(spectral);
  Vector<double> with(m), without(m);
  ASSERT_EQ(spectral.factor(j * j.transpose(), g), Ending::ok);
  Index given_up = 0;
  for (const Index q : {25, 30, 35})
    for (const double near : {1e-7, 1e-9, 1e-11, 1e-13}) {
      const Power power{.tau = truth.svd.s(q) / truth.svd.s(0) * (1 + near)};
      two.open();
      const bool taken =
          proven(two.apply(power, 1e-4, p, pullback_of(j), with), 1e-4);
      given_up += two.abandoned();
      if (taken) continue;
      two.open();
      two.apply(power, 0, p, pullback_of(j), without);
      EXPECT_EQ(two.abandoned(), 0);
      EXPECT_TRUE(test::same_bits(with, without));
    }
  EXPECT_GT(given_up, 0);
}

TEST(HalfInverse, NonFiniteInputGivesNanAndNoFurtherPath) {
  Batch<double> j = graded(10, 20, 1, 80);
  j(3, 3) = kNan;
  const std::vector<Power> all = {{.kappa = -1}, {.kappa = -0.5}};
  Batch<double> updates(20, 2);
  HalfInverse solver;
  const auto reports =
      solver(j * j.transpose(), noise(10, 1, 81), pullback_of(j), all, updates);
  for (const auto& r : reports) EXPECT_EQ(r.ending, Ending::nonfinite);
  EXPECT_TRUE(updates.array().isNaN().all());
}

TEST(DefiniteSolve, GaussNewtonWithoutASpectrum) {
  const Index m = 120, p = 150;
  const Batch<double> j = graded(m, p, 2.5, 90);
  const Batch<double> gram = j * j.transpose();
  const Vector<double> g = noise(m, 1, 91);
  const Definition truth(j, g);
  DefiniteSolve solve;
  Vector<double> v(m);
  PowerReport r;
  for (const Power power :
       {Power{.kappa = -1, .tau = 1e-5},
        Power{.kappa = -1, .tau = 0},
        Power{.kappa = -1, .tau = 1e-4, .absolute = true}}) {
    ASSERT_TRUE(solve(gram, g, power, 1e-6, v, r));
    const Vector<double> expected = truth.update(power);
    const double error =
        (j.transpose() * v - expected).norm() / expected.norm();
    EXPECT_LE(error, r.error + 1e-13);
    EXPECT_LT(error, 1e-9);
    EXPECT_EQ(r.kept, m);
    EXPECT_LE(r.smallest_kept, truth.svd.s(m - 1));
    EXPECT_GT(r.smallest_kept, r.cut);
    EXPECT_GE(r.s_max, truth.svd.s(0));
    EXPECT_GE(r.norm_bound, r.norm);
  }
  // A cut above the smallest value, another power, a singular matrix.
  EXPECT_FALSE(solve(gram, g, {.kappa = -1, .tau = 5e-3}, 1e-6, v, r));
  EXPECT_FALSE(solve(gram, g, {.kappa = -0.5, .tau = 1e-5}, 1e-6, v, r));
  EXPECT_FALSE(
      solve(gram, g, {.kappa = -1, .tau = 1e-5, .beta = 1}, 1e-6, v, r));
  Batch<double> twice(2 * m, p);
  twice << j, j;
  Vector<double> gg(2 * m), vv(2 * m);
  gg << g, g;
  EXPECT_FALSE(solve(
      twice * twice.transpose(), gg, {.kappa = -1, .tau = 0}, 1e-6, vv, r));

  const Power power{.kappa = -1, .tau = 1e-5};
  Batch<double> update(p, 1);
  HalfInverse with, without({.shortcut = false});
  EXPECT_EQ(with(gram, g, pullback_of(j), std::span(&power, 1), update)[0].path,
            Path::shortcut);
  const Vector<double> first = update;
  EXPECT_EQ(
      without(gram, g, pullback_of(j), std::span(&power, 1), update)[0].path,
      Path::gram);
  EXPECT_LT((first - update).norm(), 1e-8 * first.norm());
}

}  // namespace
}  // namespace physinv::hig
