#include "problems/marker_flow/marker_flow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "suite/core/any_problem.h"
#include "tests/support/bits.h"
#include "tests/support/gradient_check.h"
#include "tests/support/physics.h"

namespace physinv::test {
namespace {

/// A sixteenth of the cells, half the steps.
MarkerFlowOptions small() {
  return {.cells = 16, .end_time = 1, .steps = 4, .falloff = 20};
}

Samples<double> draw(Index n, const MarkerFlowOptions& options = small()) {
  return AnyProblem<double>(problems::marker_flow(options))
      .sample(0, n, Rng::root("test/marker_flow", 1));
}

template <class T>
auto physics(int threads = 1) {
  return Physics(AnyProblem<T>(problems::marker_flow(small())), threads);
}

/// Numbers without structure, between -1 and 1.
Batch<double> rough(Index rows, Index columns, Index shift) {
  return Batch<double>::NullaryExpr(rows, columns, [=](Index i, Index j) {
    const auto k = double(shift + 31 * i + 7 * j);
    return std::sin(12.9898 * (k * k + 3 * k + 1));
  });
}

TEST(MarkerFlow, GradientIsTheDerivative) {
  const auto s = draw(3);
  const Batch<double> bar = rough(256, 3, 5);
  auto bench = physics<double>();
  const Batch<double> g = bench.gradient(s.x, s.given, bar);
  for (Index direction = 0; direction < 3; ++direction) {
    const Batch<double> dot = rough(512, 3, 100 * direction + 9);
    const double h = 1e-8;  // far below most kinks
    const Batch<double> difference = (bench.forward(s.x + h * dot, s.given) -
                                      bench.forward(s.x - h * dot, s.given)) /
                                     (2 * h);
    const double there = difference.cwiseProduct(bar).sum();
    const double scale = difference.norm() * bar.norm();
    EXPECT_NEAR(there, g.cwiseProduct(dot).sum(), 1e-6 * scale);
  }
}

TEST(MarkerFlow, LossGradientIsTheDerivative) {
  const auto s = draw(2);
  const AnyProblem<double> problem(problems::marker_flow(small()));
  const Batch<double> y = s.y + 0.1 * rough(256, 2, 3), dot = rough(256, 2, 8);
  Batch<double> bar(y);
  problem.loss_gradient(y, s.y, bar);
  const auto at = [&](double h) {
    Vector<double> loss(2);
    problem.loss(y + h * dot, s.y, loss);
    return loss.sum();
  };
  const double h = 1e-6;
  EXPECT_NEAR((at(h) - at(-h)) / (2 * h), bar.cwiseProduct(dot).sum(), 1e-6);
  Vector<double> none(2);
  problem.loss(s.y, s.y, none);
  EXPECT_EQ(none, Vector<double>::Zero(2));
}

/// L over all modes, by plain sums, without its floor.
double loss_of_all_modes(const FrequencyLoss& loss,
                         const Vector<double>& difference,
                         Index n,
                         double threshold) {
  const Vector<double> d = difference.array() - difference.mean();
  double sum = 0;
  for (Index k = -n / 2; k < n / 2; ++k)
    for (Index l = -n / 2; l < n / 2; ++l) {
      std::complex<double> mode = 0;
      for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j)
          mode +=
              d(i * n + j) * std::polar(1.0,
                                        -2 * std::numbers::pi *
                                            double(k * i + l * j) / double(n));
      const double at = loss.weight(k, l) * std::abs(mode);
      sum += std::sqrt(std::max(at * at, threshold));
    }
  return sum - loss.floor();
}

// Modes too small to count are left out: the same loss, whatever the size.
TEST(FrequencyLoss, LeavesOutWhatCannotCount) {
  const Index n = 16;
  const double threshold = 1e-5;
  const FrequencyLoss loss(n, 20, threshold);
  for (const double size : {1e-3, 1.0, 1e6}) {
    const Vector<double> difference = size * rough(n * n, 1, 11).col(0);
    const double all = loss_of_all_modes(loss, difference, n, threshold);
    EXPECT_NEAR(loss(difference, nullptr), all, 1e-12 * all) << size;
  }
}

// Of densities between 0 and 1 on the experiment's grid.
TEST(FrequencyLoss, TransformsFewModes) {
  const MarkerFlowOptions o;
  const FrequencyLoss loss(o.cells, o.falloff, o.threshold);
  const double most = double(o.cells * o.cells);
  Index count = 0;
  for (Index k = -o.cells / 2; k < o.cells / 2; ++k)
    for (Index l = -o.cells / 2; l < o.cells / 2; ++l)
      count += loss.weight(k, l) * most > std::sqrt(o.threshold) ? 1 : 0;
  EXPECT_EQ(count, 61);
}

template <class T>
void expect_same_bits_everywhere() {
  const auto s = draw(19).cast<T>();  // two registers and a part
  const Batch<T> bar = rough(256, 19, 5).cast<T>();
  auto one = physics<T>(), two = physics<T>(2);
  const Batch<T> y = one.forward(s.x, s.given),
                 g = one.gradient(s.x, s.given, bar),
                 x = one.invert(s.y, s.given, s.x);
  EXPECT_TRUE(same_bits(y, two.forward(s.x, s.given)));
  EXPECT_TRUE(same_bits(g, two.gradient(s.x, s.given, bar)));
  EXPECT_TRUE(same_bits(x, two.invert(s.y, s.given, s.x)));
  // Alone, in another lane.
  const Batch<T> x11 = s.x.col(11), m11 = s.given.col(11), b11 = bar.col(11),
                 y11 = s.y.col(11);
  EXPECT_TRUE(same_bits(Batch<T>(y.col(11)), one.forward(x11, m11)));
  EXPECT_TRUE(same_bits(Batch<T>(g.col(11)), one.gradient(x11, m11, b11)));
  EXPECT_TRUE(same_bits(Batch<T>(x.col(11)), one.invert(y11, m11, x11)));
}

TEST(MarkerFlow, BitsDependOnNothingElse) {
  expect_same_bits_everywhere<float>();
  expect_same_bits_everywhere<double>();
}

/// Columns of NaN for what is lost; the others keep their bits.
template <class T>
void expect_lost_alone() {
  const auto s = draw(4).cast<T>();
  auto bench = physics<T>();
  const Batch<T> bar = rough(256, 4, 5).cast<T>();
  const Batch<T> y = bench.forward(s.x, s.given),
                 g = bench.gradient(s.x, s.given, bar),
                 found = bench.invert(s.y, s.given, s.x);
  auto bad = s;
  bad.x(7, 1) = std::numeric_limits<T>::quiet_NaN();
  bad.x(300, 2) = T(1e30);
  const Batch<T> all[][2] = {{bench.forward(bad.x, s.given), y},
                             {bench.gradient(bad.x, s.given, bar), g},
                             {bench.invert(s.y, s.given, bad.x), found}};
  for (const auto& [got, whole] : all)
    for (Index k = 0; k < 4; ++k) {
      if (k == 0 || k == 3)
        EXPECT_TRUE(same_bits(Batch<T>(got.col(k)), Batch<T>(whole.col(k))));
      else
        EXPECT_TRUE(got.col(k).array().isNaN().all());
    }
}

TEST(MarkerFlow, WhatIsNotFiniteStaysInItsColumn) {
  expect_lost_alone<float>();
  expect_lost_alone<double>();
}

TEST(MarkerFlow, NothingMovesWithoutVelocity) {
  const auto s = draw(1);
  auto bench = physics<double>();
  const Batch<double> still = Batch<double>::Zero(512, 1);
  EXPECT_EQ(bench.forward(still, s.given), s.given);
  EXPECT_TRUE(bench.gradient(still, s.given, s.given).allFinite());
  const Batch<double> empty = Batch<double>::Zero(256, 1);
  EXPECT_TRUE(bench.invert(empty, empty, still).isZero(0));
}

TEST(MarkerFlow, VelocitiesFarTooLargeAreSafe) {
  auto s = draw(2);
  s.x *= 1e4;
  const Batch<double> y = physics<double>().forward(s.x, s.given);
  EXPECT_GE(y.minCoeff(), 0);
  EXPECT_LE(y.maxCoeff(), 1);
  EXPECT_TRUE(physics<float>()
                  .gradient(s.x.cast<float>(),
                            s.given.cast<float>(),
                            s.given.cast<float>())
                  .allFinite());
}

/// Spec of the data: box, positive noise, what the truth is made of.
TEST(MarkerFlow, SamplesAreWhatTheySay) {
  const AnyProblem<double> problem(problems::marker_flow());
  const auto s = problem.sample(0, 3, Rng::root("test/marker_flow", 2));
  for (Index k = 0; k < 3; ++k) {
    const auto m = s.given.col(k);
    EXPECT_TRUE((m.array() * (1 - m.array())).isZero(0));
    EXPECT_GE(m.sum(), 50);
    EXPECT_LE(m.sum(), 0.15 * 4096 + 1);
    const MarkerPoint mass = centre_of_mass(MarkerFlowOptions{}.grid(), m);
    EXPECT_NEAR(s.x.col(k).head(4096).mean(), (64 - mass.x) / 2, 1e-10);
    EXPECT_NEAR(s.x.col(k).tail(4096).mean(), (64 - mass.y) / 2, 1e-10);
    EXPECT_LE(std::abs(MarkerFlowOptions{}.turning().strength(s.x.col(k))),
              2.01);
  }
  const auto later = problem.sample(1, 1, Rng::root("test/marker_flow", 2));
  EXPECT_TRUE(same_bits(Batch<double>(s.x.col(1)), later.x));
}

/// No exact inverse: from the exact flow without small scales it stays near the
/// vortex, and comes nearer from any other strength.
TEST(MarkerFlow, InverseDrawsNear) {
  const std::vector<double> offsets = {0, -4, -2, -1, -0.5, 0.5, 1, 2, 4};
  for (const bool timed : {false, true}) {
    const MarkerFlowOptions options{.timed_path = timed};
    Physics bench{AnyProblem<double>(problems::marker_flow(options))};
    const Vortex vortex = options.turning();
    const auto count = static_cast<Index>(offsets.size());
    const auto s = bench.problem.sample(0, 12, Rng::root("test/fluid", 3));
    for (Index k = 0; k < s.count(); ++k) {
      const double strength = vortex.strength(s.x.col(k));
      Batch<double> guess(8192, count);
      for (Index c = 0; c < 2; ++c)
        for (Index a = 0; a < 4096; ++a)
          for (Index n = 0; n < count; ++n)
            guess(c * 4096 + a, n) = s.x.col(k).segment(c * 4096, 4096).mean() +
                                     (strength + offsets[std::size_t(n)]) *
                                         vortex(int(c), a / 64, a % 64);
      const Batch<double> x = bench.invert(s.y.col(k).replicate(1, count),
                                           s.given.col(k).replicate(1, count),
                                           guess);
      const auto off = [&](const Batch<double>& of, Index n) {
        return std::abs(vortex.strength(of.col(n)) - strength);
      };
      EXPECT_LE(off(x, 0), 0.05 * std::abs(strength) + 0.015);
      for (Index n = 1; n < count; ++n)
        EXPECT_LT(off(x, n), off(guess, n)) << k << ' ' << n;
    }
  }
}

}  // namespace
}  // namespace physinv::test
