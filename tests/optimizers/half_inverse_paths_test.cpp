// Each path to a power of J against the definition.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "optimizers/half_inverse/half_inverse.h"
#include "tests/optimizers/half_inverse_truth.h"

namespace physinv::hig {

using namespace linalg;

namespace {

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
  const double s_max = truth.svd.s(0);
  EXPECT_NEAR(report.s_max / s_max, 1, 1e-13);
  EXPECT_NEAR(report.smallest_kept / truth.svd.s(report.kept - 1), 1, 1e-4);
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

}  // namespace
}  // namespace physinv::hig
