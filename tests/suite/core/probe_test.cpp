#include "suite/core/probe.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "suite/core/oracle.h"
#include "tests/support/quadratic.h"

namespace physinv::test {
namespace {

constexpr Index kExamples = 3;
const std::vector<double> kSchedule = {
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 16, 18, 20, 22};

struct ProbeTest : testing::Test {
  Oracle make() {
    return Oracle(
        quadratic(), kExamples, Rng::root("probe_test", 1), Needs::forward);
  }
  /// The iterate k of example i, and its made-up loss.
  static double at(Index i, Index k) {
    return 100 * static_cast<double>(i) + static_cast<double>(k);
  }
  static void accept(Probe& probe, Index i, Index k) {
    const double x[2] = {at(i, k), -at(i, k)};
    probe.accept(i, k, x, at(i, k));
  }
  /// Example i ended with its iterate last[i].
  static void expect_points(Probe& probe, const std::vector<Index>& last) {
    const Curve& c = probe.curve();
    for (Index p = 0; p < c.points(); ++p) {
      const auto k =
          static_cast<Index>(c.iteration[static_cast<std::size_t>(p)]);
      for (Index i = 0; i < kExamples; ++i) {
        const double expected =
            at(i, std::min(k, last[static_cast<std::size_t>(i)]));
        EXPECT_EQ(c.loss(i, p), expected) << "example " << i << " at " << k;
        if (i >= 2) continue;
        EXPECT_EQ(c.x(2 * i, p), expected);
        EXPECT_EQ(c.x(2 * i + 1, p), -expected);
      }
    }
  }
  static void nap() {
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
  }

  Oracle oracle = make();
};

TEST_F(ProbeTest, ScheduleIsDenseThenGeometric) {
  for (Index k = 0; k < 14; ++k) EXPECT_EQ(next_measured(k), k + 1);
  EXPECT_EQ(next_measured(14), 16);
  EXPECT_EQ(next_measured(100), 114);
  Index points = 0;
  for (Index k = 1000; k < 10000; k = next_measured(k)) ++points;
  EXPECT_NEAR(static_cast<double>(points), 17, 1);
}

TEST_F(ProbeTest, CountsIterationsAndMeasuresTrueLosses) {
  Probe probe(oracle, 23, 2);
  Batch<double> x = oracle.start();
  Index steps = 0;
  while (probe.proceed([&](BatchOut<double> out) { out = x; })) {
    ++steps;
    EXPECT_EQ(probe.iteration(), steps);
    x.array() += 0.01;
  }
  EXPECT_EQ(steps, 23);
  std::vector<double> schedule = kSchedule;
  schedule.push_back(23);  // the end is always measured
  const Curve& c = probe.curve();
  EXPECT_EQ(c.iteration, schedule);
  EXPECT_EQ(c.loss.cols(), c.points());
  EXPECT_EQ(c.x.rows(), 4);
  Vector<double> loss(kExamples);
  oracle.measure(x, loss);
  EXPECT_EQ(c.loss.rightCols(1), loss);
  EXPECT_EQ(c.x(2, c.points() - 1), x(0, 1));
  EXPECT_EQ(oracle.counts(), Counts{});
}

TEST_F(ProbeTest, NoIterationsStillMeasureTheStart) {
  Probe probe(oracle, 0);
  const Batch<double> x = oracle.start();
  EXPECT_FALSE(probe.proceed([&](BatchOut<double> out) { out = x; }));
  EXPECT_EQ(probe.curve().points(), 1);
}

TEST_F(ProbeTest, StopEndsAtTheNextLook) {
  Probe probe(oracle, 1000);
  const Batch<double> x = oracle.start();
  const auto estimate = [&](BatchOut<double> out) { out = x; };
  for (int i = 0; i < 15; ++i) ASSERT_TRUE(probe.proceed(estimate));
  probe.stop();
  EXPECT_FALSE(probe.proceed(estimate));
  EXPECT_EQ(probe.iteration(), 15);
  EXPECT_EQ(probe.curve().iteration.back(), 15);
}

TEST_F(ProbeTest, AcceptInLockstep) {
  Probe probe(oracle, 1000, 2);
  const std::vector<Index> last = {25, 4, 17};
  for (Index k = 0; k <= 25; ++k)
    for (Index i = 0; i < kExamples; ++i)
      if (k <= last[static_cast<std::size_t>(i)]) accept(probe, i, k);
  probe.finish();
  std::vector<double> schedule = kSchedule;
  schedule.push_back(25);
  EXPECT_EQ(probe.curve().iteration, schedule);
  expect_points(probe, last);
}

TEST_F(ProbeTest, AcceptOneExampleAfterTheOther) {
  for (const std::vector<Index>& last :
       {std::vector<Index>{25, 4, 17}, {4, 25, 40}, {0, 0, 0}, {15, 16, 15}}) {
    Probe probe(oracle, 1000, 2);
    for (Index i = 0; i < kExamples; ++i)
      for (Index k = 0; k <= last[static_cast<std::size_t>(i)]; ++k)
        accept(probe, i, k);
    probe.finish();
    EXPECT_EQ(probe.curve().iteration.back(),
              *std::max_element(last.begin(), last.end()));
    expect_points(probe, last);
  }
}

TEST_F(ProbeTest, AnExampleThatNeverStartedHasNoNumbers) {
  Probe probe(oracle, 1000);
  for (Index k = 0; k <= 3; ++k) accept(probe, 0, k), accept(probe, 2, k);
  probe.finish();
  EXPECT_EQ(probe.curve().points(), 4);
  EXPECT_TRUE(probe.curve().loss.row(1).array().isNaN().all());
  EXPECT_EQ(probe.curve().loss(2, 3), at(2, 3));

  Probe nobody(oracle, 1000);
  nobody.finish();
  EXPECT_EQ(nobody.curve().points(), 1);
  EXPECT_TRUE(nobody.curve().loss.array().isNaN().all());
}

TEST_F(ProbeTest, TheClockStandsStillWhileMeasuring) {
  Probe probe(oracle, 2);
  const Batch<double> x = oracle.start();
  probe.set_observer([](Index, VectorIn<double>) { nap(); });
  while (probe.proceed([&](BatchOut<double> out) { nap(), out = x; })) {
  }
  const Clocks clocks = probe.clocks();
  EXPECT_LT(clocks.solve.wall, 0.06);  // of 0.36 seconds altogether
  EXPECT_GE(clocks.measure.wall, 0.36);
  EXPECT_LT(probe.curve().seconds.back(), 0.06);

  Probe accepting(oracle, 2);
  accepting.set_observer([](Index, VectorIn<double>) { nap(); });
  accepting.begin();
  for (Index k = 0; k < 4; ++k) accept(accepting, 0, k);
  accepting.finish();
  EXPECT_LT(accepting.clocks().solve.wall, 0.06);
}

TEST_F(ProbeTest, WhatComesAfterTheEndIsMeasuring) {
  Probe probe(oracle, 0);
  const Batch<double> x = oracle.start();
  while (probe.proceed([&](BatchOut<double> out) { out = x; })) {
  }
  nap();  // such as final estimates and their losses
  EXPECT_GE(probe.clocks().measure.wall, 0.05);
  EXPECT_LT(probe.clocks().solve.wall, 0.05);
}

TEST_F(ProbeTest, TellsObservationsOfWhatItMeasures) {
  Probe probe(oracle, 3);
  Batch<double> x = oracle.start();
  Index points = 0;
  const auto estimate = [&](BatchOut<double> out) { out = x; };
  const auto measured = [&](BatchIn<double> at, BatchIn<double> y) {
    Batch<double> again(y.rows(), y.cols());
    Vector<double> loss(kExamples);
    oracle.measure(at, again, loss);
    EXPECT_EQ(at, x);
    EXPECT_EQ(y, again);
    EXPECT_EQ(loss, probe.curve().loss.col(points++));
  };
  while (probe.proceed(estimate, measured)) x.array() += 0.25;
  EXPECT_EQ(points, 4);
}

TEST_F(ProbeTest, KnowsTheLossesOfWhatWasMeasuredLast) {
  Probe probe(oracle, 1);
  Batch<double> x = oracle.start();
  Vector<double> loss(kExamples), measured(kExamples);
  EXPECT_FALSE(probe.knows_losses(x, loss));
  while (probe.proceed([&](BatchOut<double> out) { out = x; }))
    x.array() += 0.5;
  oracle.measure(x, measured);
  ASSERT_TRUE(probe.knows_losses(x, loss));
  EXPECT_EQ(loss, measured);
  x(0) = std::nextafter(x(0), 9.0);
  EXPECT_FALSE(probe.knows_losses(x, loss));
  EXPECT_FALSE(probe.knows_losses(x.leftCols(1), loss));

  Probe told(oracle, 1);
  accept(told, 0, 0);
  told.finish();
  Batch<double> last = Batch<double>::Constant(2, kExamples, 0);
  EXPECT_FALSE(told.knows_losses(last, loss));
}

TEST_F(ProbeTest, SetUpAndWarmUpHaveTheirOwnClocks) {
  Probe probe(oracle, 1);
  nap();
  probe.begin_warmup();
  nap();
  probe.begin();
  const Batch<double> x = oracle.start();
  while (probe.proceed([&](BatchOut<double> out) { out = x; })) nap();
  const Clocks clocks = probe.clocks();
  for (const double wall :
       {clocks.setup.wall, clocks.warmup.wall, clocks.solve.wall}) {
    EXPECT_GE(wall, 0.05);
    EXPECT_LT(wall, 0.5);
  }
  const double solved = clocks.solve.wall;
  nap();
  EXPECT_EQ(probe.clocks().solve.wall, solved) << "the end stops the clock";
}

TEST_F(ProbeTest, WorkAsideHasItsOwnClockOrNone) {
  Probe probe(oracle, 1);
  {
    const Probe::Aside aside = probe.drawing();  // still set-up
    nap();
  }
  EXPECT_EQ(probe.clocks().data.wall, 0);
  EXPECT_GE(probe.clocks().setup.wall, 0.05);
  probe.begin();
  {
    const Probe::Aside aside = probe.drawing();
    nap();
  }
  {
    const Probe::Aside aside = probe.measuring();
    nap(), nap();
  }
  {
    const Probe::Aside aside = probe.recording();
    nap(), nap(), nap();
  }
  const Clocks clocks = probe.clocks();
  EXPECT_GE(clocks.data.wall, 0.05);
  EXPECT_GE(clocks.measure.wall, 2 * 0.05);
  EXPECT_LT(clocks.solve.wall, clocks.data.wall) << "it stood still";
}

TEST_F(ProbeTest, ObserversSeeEveryPoint) {
  Probe probe(oracle, 9);
  std::vector<double> seen;
  probe.set_observer([&](Index k, VectorIn<double> loss) {
    seen.push_back(static_cast<double>(k));
    EXPECT_EQ(loss.size(), kExamples);
    EXPECT_TRUE(loss.allFinite());
  });
  const Batch<double> x = oracle.start();
  while (probe.proceed([&](BatchOut<double> out) { out = x; })) {
  }
  EXPECT_EQ(seen, probe.curve().iteration);
}

TEST_F(ProbeTest, TracesOnlyWhenAsked) {
  Probe probe(oracle, 1);
  EXPECT_FALSE(probe.traced());
  probe.trace("x", 1);
  std::string text;
  probe.set_trace([&](const void* data, std::size_t bytes) {
    text.append(static_cast<const char*>(data), bytes);
  });
  EXPECT_TRUE(probe.traced());
  probe.trace("ab", 2), probe.trace("c", 1);
  EXPECT_EQ(text, "abc");
}

TEST_F(ProbeTest, HashesEveryNanAlike) {
  const auto trajectory = [&](auto value) {
    Probe probe(oracle, 1);
    probe.follow();
    const decltype(value) values[] = {1, value, 2};
    probe.trace(values, sizeof(values));
    return probe.trajectory();
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(trajectory(-kNan), trajectory(kNan));
  EXPECT_EQ(trajectory(-std::nanf("7")), trajectory(std::nanf("")));
  EXPECT_NE(trajectory(kNan), trajectory(0.0));
  EXPECT_NE(trajectory(-0.0), trajectory(0.0));
}

}  // namespace
}  // namespace physinv::test
