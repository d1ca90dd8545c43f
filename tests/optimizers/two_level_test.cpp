// A second level for the directions that J J^T does not tell apart.
#include "optimizers/half_inverse/two_level.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "suite/core/threads.h"
#include "tests/optimizers/half_inverse_truth.h"
#include "tests/support/bits.h"

namespace physinv::hig {

using namespace linalg;

namespace {

/// Values a thousandth apart on both sides of the cut: the Gram matrix cannot
/// tell their directions apart, those of the rest need no second level.
TEST(TwoLevel, OnlyAroundTheCut) {
  const Index m = 120;
  const double cut = 1e-6;
  const Batch<double> left = orthonormal(m, m, 160),
                      right = orthonormal(150, m, 161);
  Vector<double> s(m);
  for (Index i = 0; i < m; ++i)
    s(i) = i < m - 12
               ? std::pow(10, -3 * static_cast<double>(i) / (m - 12.0))
               : cut * (1 + 1e-3 * (static_cast<double>(m - 7 - i) + 0.5));
  Batch<double> j = left * s.asDiagonal() * right.transpose();
  const Vector<double> g = noise(m, 1, 162);
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
    Vector<double> c = left.transpose() * g;
    for (Index i = 0; i < m; ++i)
      c(i) *= s(i) > cut ? std::pow(s(i), kappa) : 0.0;
    const Vector<double> expected = right * c;
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

TEST(TwoLevel, OfExactZeros) {
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

/// The second level's Gram matrix is a product of Eigen's, which sums in blocks
/// of the caches that it believes in.
TEST(TwoLevel, WhateverCachesTheProgramStates) {
  const Index m = 40, parameters = 3000;
  const Batch<double> j = graded(m, parameters, 7, 167);
  const Vector<double> g = noise(m, 1, 168);
  SpectralPower first;
  ASSERT_EQ(first.factor(j * j.transpose(), g), Ending::ok);
  const Power power{.kappa = -1, .tau = 1e-6};
  const auto run = [&] {
    TwoLevelPower two(first);
    Vector<double> v(m);
    two.apply(power, 1e-9, parameters, pullback_of(j), v);
    EXPECT_GT(two.second_level(), 4);
    return v;
  };
  const Vector<double> expected = run();
  Eigen::setCpuCacheSizes(8 << 10, 64 << 10, 1 << 20);
  EXPECT_TRUE(test::same_bits(run(), expected));
}

/// E between directions of small values, from J itself: the estimates of the
/// error rest on its size.
TEST(SpectralPower, RoundingIsOfTheSizeOfTheModel) {
  const Index m = 200;
  std::vector<Batch<double>> all = {
      graded(m, m + 20, 5, 180),
      graded(m, m + 20, 9, 182),
      noise(m, 8, 184) * noise(8, m, 185) + 1e-7 * noise(m, m, 186)};
  Batch<double> twice(m, m);
  twice << graded(m / 2, m, 6, 187), graded(m / 2, m, 6, 187);
  all.push_back(twice);
  Batch<double> rows = noise(m, m + 9, 188);  // single rows are all of G
  for (Index i = 0; i < m; ++i)
    rows.row(m - 1 - i) *=
        std::pow(10, -6 * static_cast<double>(i) / static_cast<double>(m));
  all.push_back(rows);
  for (const Batch<double>& j : all)
    for (const Stages stages : {Stages::one, Stages::two}) {
      SpectralPower power;
      ASSERT_EQ(power.factor(j * j.transpose(), noise(m, 1, 189), 1, stages),
                Ending::ok);
      const Spectrum& spectrum = power.spectrum();
      std::vector<Index> small;
      for (Index i = 0; i < m; ++i)
        if (spectrum.s(i) < 1e-3 * spectrum.s_max()) small.push_back(i);
      const auto count = static_cast<Index>(small.size());
      Batch<double> u(m, count);
      power.directions(small, u);
      const Batch<double> w = j.transpose() * u;
      Batch<double> e = w.transpose() * w;
      for (Index k = 0; k < count; ++k)
        e(k, k) -= std::pow(spectrum.s(small[static_cast<std::size_t>(k)]), 2);
      const double seen =
          e.norm() / static_cast<double>(count) / std::pow(spectrum.s_max(), 2);
      EXPECT_LT(seen, spectrum.noise.gram);
      EXPECT_GT(seen, spectrum.noise.gram / 20);
    }
}

TEST(SpectralPower, DirectionsEightAbreast) {
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

}  // namespace
}  // namespace physinv::hig
