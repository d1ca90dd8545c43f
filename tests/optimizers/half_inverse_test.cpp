#include "optimizers/half_inverse/half_inverse.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "optimizers/half_inverse/structured_gram.h"
#include "suite/core/check.h"

namespace physinv::hig {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Batch<double> noise(Index rows, Index cols, std::uint32_t seed) {
  Batch<double> x(rows, cols);
  std::uint32_t k = seed * 7919u;
  const auto uniform = [&] {
    std::uint32_t h = ++k;
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return ((h ^ (h >> 16)) + 0.5) / 4294967296.0;
  };
  for (Index i = 0; i < x.size(); ++i)
    x.data()[i] =
        std::sqrt(-2 * std::log(uniform())) * std::cos(2 * M_PI * uniform());
  return x;
}

/// Singular values 1 .. 10^-decades between random bases.
Batch<double> graded(Index m, Index p, double decades, std::uint32_t seed) {
  const Index n = std::min(m, p);
  const auto basis = [&](Index rows, std::uint32_t s) {
    const Eigen::HouseholderQR<Batch<double>> qr(noise(rows, n, s));
    Batch<double> q = Batch<double>::Identity(rows, n);
    q.applyOnTheLeft(qr.householderQ());
    return q;
  };
  Vector<double> s(n);
  for (Index i = 0; i < n; ++i)  // not on a power of ten, where the cuts are
    s(i) = std::pow(
        10.0,
        -decades * (static_cast<double>(i) + 0.37) / static_cast<double>(n));
  s(0) = 1;
  return basis(m, seed) * s.asDiagonal() * basis(p, seed + 1).transpose();
}

/// The definition, by Eigen's two-sided Jacobi SVD of J.
struct Definition {
  Eigen::JacobiSVD<Batch<double>> svd;
  Vector<double> c;
  Definition(const Batch<double>& j, const Vector<double>& g)
      : svd(j, Eigen::ComputeThinU | Eigen::ComputeThinV),
        c(svd.matrixU().transpose() * g) {}

  double cut(const Power& p) const {
    return p.absolute ? p.tau : p.tau * svd.singularValues()(0);
  }
  Index kept(const Power& p) const {
    return (svd.singularValues().array() > cut(p)).count();
  }
  Vector<double> update(const Power& p) const {
    Vector<double> w = c;
    for (Index i = 0; i < w.size(); ++i) {
      const double s = svd.singularValues()(i);
      w(i) *= s > cut(p) ? std::pow(s, p.kappa) : 0.0;
    }
    return std::pow(svd.singularValues()(0), p.beta) * (svd.matrixV() * w);
  }
};

Pullback pullback_of(const Batch<double>& j) {
  return [&j](BatchIn<double> u, BatchOut<double> out) {
    out.noalias() = j.transpose() * u;
  };
}

const std::vector<double> kKappas = {1, 0.5, 0, -0.25, -0.5, -0.75, -1};

std::vector<Power> powers() {
  std::vector<Power> all;
  for (const double kappa : kKappas) {
    for (const double tau : {0.1, 1e-3, 1e-5})
      all.push_back({.kappa = kappa, .tau = tau});
    all.push_back({.kappa = kappa, .tau = 2e-4, .absolute = true});
    all.push_back({.kappa = kappa, .tau = 1e-4, .beta = -0.25});
  }
  return all;
}

struct Case {
  std::string name;
  Batch<double> j;
  Vector<double> g;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](const std::string& name, Batch<double> j) {
    const Vector<double> g = noise(j.rows(), 1, 77);
    all.push_back({name, std::move(j), g});
  };
  add("wide", graded(60, 110, 4, 1));
  add("tall", graded(110, 40, 3, 2));
  add("one row", graded(1, 9, 0, 3));
  add("one column", graded(9, 1, 0, 4));
  add("band and more", graded(131, 140, 5, 5));
  Batch<double> rank = graded(70, 20, 2, 6) * noise(20, 90, 7);
  add("rank deficient", rank);
  Batch<double> twice(60, 80);
  twice << graded(30, 80, 3, 8), graded(30, 80, 3, 8);
  add("duplicates", twice);
  Batch<double> dead = graded(50, 70, 3, 9);
  dead.middleRows(10, 15).setZero();
  add("zero rows", dead);
  add("scaled up", graded(40, 60, 4, 10) * 1e40);
  add("scaled down", graded(40, 60, 4, 11) * 1e-40);
  return all;
}

/// What every path must fulfil against the definition.
void check(const Case& c,
           const Power& p,
           const Definition& truth,
           const PowerReport& report,
           const Vector<double>& update,
           bool doubtful_noise) {
  SCOPED_TRACE(c.name + " kappa " + std::to_string(p.kappa) + " tau " +
               std::to_string(p.tau) + " beta " + std::to_string(p.beta) +
               (p.absolute ? " absolute" : ""));
  if (truth.kept(p) == 0) {
    EXPECT_EQ(report.ending, Ending::zero);
    EXPECT_TRUE(update.isZero(0));
    return;
  }
  ASSERT_EQ(report.ending, Ending::ok);
  if (doubtful_noise && !std::isfinite(report.error)) return;
  EXPECT_EQ(report.kept, truth.kept(p));
  const double s_max = truth.svd.singularValues()(0);
  EXPECT_NEAR(report.s_max / s_max, 1, 1e-13);
  EXPECT_NEAR(
      report.smallest_kept / truth.svd.singularValues()(report.kept - 1),
      1,
      1e-4);
  const Vector<double> expected = truth.update(p);
  const double error = (update - expected).norm() / expected.norm();
  EXPECT_LE(error, report.error + 1e-12);
  EXPECT_LT(report.error, 1e-2);
  EXPECT_NEAR(report.norm / expected.norm(), 1, report.error + 1e-12);
  EXPECT_LE(update.norm(), report.norm_bound * (1 + report.error + 1e-12));
}

TEST(HalfInverse, SpectralPathAgainstTheDefinition) {
  for (const Case& c : cases()) {
    const Batch<double> gram = c.j * c.j.transpose();
    const Definition truth(c.j, c.g);
    for (const Stages stages : {Stages::one, Stages::two}) {
      SpectralPower spectral;
      ASSERT_EQ(spectral.factor(gram, c.g, 1, stages), Ending::ok) << c.name;
      Vector<double> v(c.g.size());
      for (const Power& p : powers()) {
        const PowerReport report = spectral.apply(p, v);
        check(c, p, truth, report, c.j.transpose() * v, false);
      }
    }
  }
}

TEST(HalfInverse, TwoLevelsAgainstTheDefinition) {
  for (const Case& c : cases()) {
    const Batch<double> gram = c.j * c.j.transpose();
    const Definition truth(c.j, c.g);
    SpectralPower first;
    TwoLevelPower two(first);
    ASSERT_EQ(first.factor(gram, c.g), Ending::ok);
    Vector<double> v(c.g.size());
    for (const double tolerance : {0.0, 1e-9, 1e-4})
      for (const Power& p : powers()) {
        const PowerReport report =
            two.apply(p, tolerance, c.j.cols(), pullback_of(c.j), v);
        check(c, p, truth, report, c.j.transpose() * v, false);
      }
  }
}

/// Values a thousandth apart on both sides of the cut: the Gram matrix cannot
/// tell their directions apart, those of the rest need no second level.
TEST(HalfInverse, SecondLevelAroundTheCut) {
  const Index m = 120;
  const double cut = 1e-6;
  Batch<double> j = graded(m, 150, 3, 160);
  const Eigen::BDCSVD<Batch<double>> parts(
      j, Eigen::ComputeThinU | Eigen::ComputeThinV);
  Vector<double> s = parts.singularValues();
  for (Index i = m - 12; i < m; ++i)
    s(i) = cut * (1 + 1e-3 * (static_cast<double>(m - 7 - i) + 0.5));
  j = parts.matrixU() * s.asDiagonal() * parts.matrixV().transpose();
  const Vector<double> g = noise(m, 1, 161);
  SpectralPower first;
  ASSERT_EQ(first.factor(j * j.transpose(), g), Ending::ok);
  Index asked = 0;
  TwoLevelPower two(first);
  const Pullback pullback = [&](BatchIn<double> u, BatchOut<double> out) {
    asked += u.cols();
    out.noalias() = j.transpose() * u;
  };
  Vector<double> v(m), w(m);
  for (const double kappa : {-0.5, -1.0}) {
    const Power power{.kappa = kappa, .tau = cut, .absolute = true};
    EXPECT_GT(first.apply(power, v).error, 1e-3);
    // The definition, from the parts that J was made of.
    Vector<double> c = parts.matrixU().transpose() * g;
    for (Index i = 0; i < m; ++i)
      c(i) *= s(i) > cut ? std::pow(s(i), kappa) : 0.0;
    const Vector<double> expected = parts.matrixV() * c;
    const PowerReport report = two.apply(power, 1e-3, 150, pullback, v);
    EXPECT_EQ(report.kept, m - 6);
    EXPECT_LE(report.error, 1e-3);
    EXPECT_LE((j.transpose() * v - expected).norm(),
              report.error * expected.norm());
    EXPECT_EQ(two.second_level(), 12);
    EXPECT_EQ(asked, 12);  // the second setting has the range of the first
  }
  // Another matrix, the same directions: nothing is left of the one before.
  ASSERT_EQ(first.factor(4 * j * j.transpose(), g), Ending::ok);
  two.open();
  j *= 2;
  const Power power{.kappa = -1, .tau = 2 * cut, .absolute = true};
  EXPECT_LE(two.apply(power, 1e-3, 150, pullback, w).error, 1e-3);
  EXPECT_EQ(asked, 24);
  EXPECT_LT((4 * w - v).norm(), 1e-9 * v.norm());
}

TEST(HalfInverse, SecondLevelOfExactZeros) {
  const Index m = 50, dead = 10;
  Batch<double> j = graded(m, 70, 3, 165);
  Vector<double> g = noise(m, 1, 166);
  j.bottomRows(dead).setZero(), g.tail(dead).setZero();
  const Definition truth(j, g);
  SpectralPower first;
  ASSERT_EQ(first.factor(j * j.transpose(), g), Ending::ok);
  TwoLevelPower two(first);
  Vector<double> v(m);
  const Power power{.kappa = -1, .tau = 1e-8};
  const PowerReport report = two.apply(power, 0, 70, pullback_of(j), v);
  EXPECT_GE(two.second_level(), dead);
  ASSERT_EQ(report.ending, Ending::ok);
  EXPECT_EQ(report.kept, m - dead);
  const Vector<double> expected = truth.update(power);
  EXPECT_LE((j.transpose() * v - expected).norm(), 1e-9 * expected.norm());
}

TEST(HalfInverse, DirectionsEightAbreast) {
  for (const Index m : {1, 2, 9, 40, 150})
    for (const Stages stages : {Stages::one, Stages::two}) {
      const Batch<double> j = graded(m, m + 3, 6, 170);
      const Batch<double> gram = j * j.transpose();
      Threads threads(3);
      SpectralPower power(&threads);
      ASSERT_EQ(power.factor(gram, noise(m, 1, 171), 1, stages), Ending::ok);
      std::vector<Index> which;
      for (Index i = 0; i < m; i += 1 + i % 3) which.push_back(m - 1 - i);
      const auto count = static_cast<Index>(which.size());
      Batch<double> u(m, count);
      power.directions(which, u);
      for (Index k = 0; k < count; ++k) {
        const Index i = which[static_cast<std::size_t>(k)];
        Vector<double> one = Vector<double>::Unit(m, i);
        power.leave_eigenbasis(one);
        EXPECT_LT((u.col(k) - one).norm(), 1e-13);
        const double lambda = power.spectrum().s(i) * power.spectrum().s(i);
        EXPECT_LT((gram * one - lambda * one).norm(), 1e-14);
      }
    }
}

TEST(HalfInverse, ExplicitJacobianAgainstTheDefinition) {
  for (const Case& c : cases()) {
    const Definition truth(c.j, c.g);
    ExplicitPower power;
    ASSERT_EQ(power.factor(c.j, c.g), Ending::ok);
    Vector<double> update(c.j.cols());
    for (const Power& p : powers()) {
      const PowerReport report = power.apply(p, update);
      check(c, p, truth, report, update, false);
      EXPECT_LT(report.error, 1e-7) << c.name;
    }
  }
}

/// Cuts far below what a Gram matrix resolves: the paths must say so, and the
/// last one must still be right.
TEST(HalfInverse, SmallCuts) {
  for (const double decades : {6.0, 9.0}) {
    const Index m = 90;
    const Case c{"small cuts", graded(m, 120, decades, 20), noise(m, 1, 21)};
    const Batch<double> gram = c.j * c.j.transpose();
    // The reference on the triangle of the rows: relative accuracy of s.
    const Definition truth(c.j, c.g);
    SpectralPower spectral;
    TwoLevelPower two(spectral);
    ExplicitPower full;
    ASSERT_EQ(spectral.factor(gram, c.g), Ending::ok);
    ASSERT_EQ(full.factor(c.j, c.g), Ending::ok);
    Vector<double> v(m), u(120);
    int unproven = 0;
    for (const double kappa : kKappas)
      for (const double tau : {1e-5, 1e-6, 1e-7, 1e-8}) {
        const Power p{.kappa = kappa, .tau = tau};
        SCOPED_TRACE(std::to_string(kappa) + " " + std::to_string(tau));
        const Vector<double> expected = truth.update(p);
        const auto error = [&](const Vector<double>& update) {
          return (update - expected).norm() / expected.norm();
        };
        PowerReport r = spectral.apply(p, v);
        EXPECT_LE(error(c.j.transpose() * v), r.error + 1e-12);
        unproven += r.error > 1e-2;
        r = two.apply(p, 1e-3, 120, pullback_of(c.j), v);
        EXPECT_LE(error(c.j.transpose() * v), r.error + 1e-12);
        EXPECT_EQ(r.kept, truth.kept(p));
        r = full.apply(p, u);
        EXPECT_LE(error(u), r.error + 1e-12);
        EXPECT_EQ(r.kept, truth.kept(p));
        EXPECT_LT(error(u), 1e-6);
      }
    if (decades == 9) {
      EXPECT_GT(unproven, 0);
    }
  }
}

/// An estimate that is always huge would be honest too.
TEST(HalfInverse, EstimateIsNotOffByOrders) {
  for (const Index m : {40, 150}) {
    const Case c{"", graded(m, m + 30, 6, 30), noise(m, 1, 31)};
    const Definition truth(c.j, c.g);
    SpectralPower spectral;
    ASSERT_EQ(spectral.factor(c.j * c.j.transpose(), c.g), Ending::ok);
    Vector<double> v(m);
    for (const double kappa : {0.0, -0.5, -1.0})
      for (const double tau : {1e-4, 1e-5}) {
        const Power p{.kappa = kappa, .tau = tau};
        const PowerReport r = spectral.apply(p, v);
        const Vector<double> expected = truth.update(p);
        const double error =
            (c.j.transpose() * v - expected).norm() / expected.norm();
        EXPECT_LT(r.error, 1e-3);
        EXPECT_GT(error, r.error / 1000) << m << " " << kappa << " " << tau;
        EXPECT_LT(error, r.error);
      }
  }
}

TEST(HalfInverse, DoubtAboutTheKeptSetIsSaid) {
  Batch<double> j = Batch<double>::Zero(6, 6);
  j.diagonal() << 1, 0.5, 1e-3 * (1 + 1e-15), 1e-5, 1e-6, 0;
  const Vector<double> g = Vector<double>::Ones(6);
  SpectralPower spectral;
  ASSERT_EQ(spectral.factor(j * j.transpose(), g), Ending::ok);
  Vector<double> v(6);
  const Power power{.kappa = -0.5, .tau = 1e-3};
  EXPECT_GT(spectral.apply(power, v).error, 0.1);
  EXPECT_LT(spectral.apply({.kappa = -0.5, .tau = 2e-3}, v).error, 1e-8);
}

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
    EXPECT_LE(r.smallest_kept, truth.svd.singularValues()(m - 1));
    EXPECT_GT(r.smallest_kept, r.cut);
    EXPECT_GE(r.s_max, truth.svd.singularValues()(0));
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

TEST(HalfInverse, BitsDoNotDependOnThreads) {
  for (const Index m : {70, 420, 600}) {
    const Batch<double> j = noise(m, m / 2, 100);
    const Batch<double> gram = j * j.transpose();
    const Vector<double> g = noise(m, 1, 101);
    for (const Stages stages : {Stages::one, Stages::two}) {
      Vector<double> serial(m), v(m);
      SpectralPower one;
      ASSERT_EQ(one.factor(gram, g, 1, stages), Ending::ok);
      one.apply({.tau = 1e-4}, serial);
      for (const int count : {2, 3}) {
        Threads threads(count);
        SpectralPower several(&threads);
        ASSERT_EQ(several.factor(gram, g, 1, stages), Ending::ok);
        several.apply({.tau = 1e-4}, v);
        EXPECT_TRUE(v == serial) << m << " " << count;
      }
      // A second matrix of another size leaves no traces in the scratch.
      Vector<double> small(2);
      ASSERT_EQ(one.factor(gram.topLeftCorner(2, 2), g.head(2), 1, stages),
                Ending::ok);
      one.apply({}, small);
      ASSERT_EQ(one.factor(gram, g, 1, stages), Ending::ok);
      one.apply({.tau = 1e-4}, v);
      EXPECT_TRUE(v == serial);
    }
  }
}

TEST(Tridiagonalize, SimilarAndLeavesTheFirstCoordinate) {
  for (const Index n : {1, 2, 3, 5, 17, 32, 33, 34, 40, 64, 65, 97, 130, 257})
    for (const Stages stages : {Stages::one, Stages::two}) {
      const Batch<double> j = noise(n, n, 110);
      const Batch<double> a = j + j.transpose();
      Tridiagonalize t;
      const Symmetric s = t.matrix(n);
      for (Index c = 0; c < n; ++c)
        for (Index r = c; r < n; ++r) s.row(c)[r] = a(r, c);
      t.reduce(stages);
      Batch<double> q = Batch<double>::Identity(n, n);
      for (Index i = 0; i < n; ++i) t.apply(q.col(i).data());
      Batch<double> d = t.diagonal().asDiagonal();
      for (Index i = 0; i + 1 < n; ++i)
        d(i, i + 1) = d(i + 1, i) = t.off_diagonal()(i);
      EXPECT_LT((q * d * q.transpose() - a).norm(), 1e-14 * a.norm() * 5);
      EXPECT_LT((q.transpose() * q - Batch<double>::Identity(n, n)).norm(),
                1e-13);
      EXPECT_TRUE(q.col(0) == (Vector<double>::Unit(n, 0)));
    }
}

TEST(TridiagonalQr, RotationsForwardsAndBackwards) {
  for (const Index n : {1, 2, 3, 50, 300}) {
    Vector<double> d = noise(n, 1, 120), e = noise(n, 1, 121).topRows(n - 1);
    Batch<double> t = d.asDiagonal();
    for (Index i = 0; i + 1 < n; ++i) t(i, i + 1) = t(i + 1, i) = e(i);
    Vector<double> x = noise(n, 1, 122);
    const Vector<double> start = x;
    TridiagonalQr qr;
    ASSERT_TRUE(qr.run(d, e, x));
    EXPECT_LT(qr.sweeps(), 5 * n);
    Vector<double> back = x;
    qr.apply(back.data());
    EXPECT_LT((back - start).norm(), 1e-13 * start.norm() * 5);
    back = d.cwiseProduct(x);  // T start = W lambda W^T start
    qr.apply(back.data());
    EXPECT_LT((back - t * start).norm(), 1e-12 * (t * start).norm());
  }
}

/// J of a network from its definition: rows (a outer B, B).
template <class T>
void structured_gram(Index samples, Index rows) {
  struct Layer {
    Index in, out;
    bool bias;
    Index positions = 1, channels = 0;  ///< a patch moves by so many inputs
    Index all_in() const { return (positions - 1) * channels + in; }
  };
  // The convolutions: one by its columns, one by pairs, and one so wide that
  // the layers are taken in several groups.
  const std::vector<Layer> shape = {{3, 20, true},
                                    {6, 5, true, 9, 2},
                                    {12, 5, true, 2, 4},
                                    {20, 7, false},
                                    {60, 21, true, 8, 20},
                                    {6, 5, false, 3, 2},
                                    {1, 1, true}};
  const Index m = samples * rows;
  std::vector<Batch<T>> data;
  std::vector<GramLayer<T>> layers;
  Batch<double> j(m, 0);
  for (const Layer& l : shape) {
    data.push_back(noise(samples + 3, l.all_in(), 130).template cast<T>());
    data.push_back(noise(m + 5, l.positions * l.out, 131).template cast<T>());
  }
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const Batch<T>&a = data[2 * i], &b = data[2 * i + 1];
    layers.push_back({.a = a.data(),
                      .inputs = shape[i].in,
                      .a_stride = a.rows(),
                      .b = b.data(),
                      .outputs = shape[i].out,
                      .b_stride = b.rows(),
                      .bias = shape[i].bias,
                      .positions = shape[i].positions,
                      .a_step = shape[i].channels,
                      .b_step = shape[i].out});
    for (Index in = 0; in < shape[i].in + (shape[i].bias ? 1 : 0); ++in)
      for (Index out = 0; out < shape[i].out; ++out) {
        j.conservativeResize(m, j.cols() + 1);
        for (Index r = 0; r < m; ++r) {
          double sum = 0;
          for (Index p = 0; p < shape[i].positions; ++p)
            sum +=
                static_cast<double>(b(r, p * shape[i].out + out)) *
                (in < shape[i].in ? static_cast<double>(
                                        a(r / rows, p * shape[i].channels + in))
                                  : 1.0);
          j(r, j.cols() - 1) = sum;
        }
      }
  }
  const Batch<double> expected = j * j.transpose();
  Batch<double> g = Batch<double>::Constant(m, m, 7), threaded = g;
  StructuredGram gram;
  gram.template operator()<T>(layers, samples, rows, g);
  Threads threads(3);
  gram.template operator()<T>(layers, samples, rows, threaded, &threads);
  EXPECT_TRUE(g == threaded);
  for (Index c = 0; c < m; ++c)
    for (Index r = 0; r < m; ++r) {
      if (r < c) {
        ASSERT_EQ(g(r, c), 7);
      } else {
        ASSERT_NEAR(
            g(r, c), expected(r, c), 1e-13 * expected.diagonal().maxCoeff())
            << samples << " x " << rows << ": " << r << ", " << c;
      }
    }
}

TEST(StructuredGram, EqualsTheExplicitProduct) {
  for (const auto& [samples, rows] : std::vector<std::pair<Index, Index>>{
           {1, 1}, {1, 5}, {40, 1}, {9, 2}, {33, 4}, {3, 28}, {5, 64}}) {
    structured_gram<double>(samples, rows);
    structured_gram<float>(samples, rows);
  }
}

}  // namespace
}  // namespace physinv::hig
