#include "optimizers/jpo.h"

#include <gtest/gtest.h>

#include <cmath>

#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "tests/support/bits.h"
#include "tests/support/quadratic.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

constexpr Index kProblems = 12;

TEST(Jpo, KeepsTheBestEstimateOfEachExample) {
  // A rate that makes the losses jump: the last iterate is rarely the best.
  const auto jpo = jpo_fit({.step = AdamOptions{.rate = 0.3}});
  StageBench bench(*jpo, kProblems, 25);
  const Outcome out = bench.run();
  const Batch<double> losses = bench.traced<double>(kProblems);
  ASSERT_EQ(losses.cols(), 26);
  const Vector<double> best = losses.rowwise().minCoeff();
  EXPECT_TRUE(same_bits(bench.loss(out.x), best));
  EXPECT_GT((losses.col(25) - best).maxCoeff(), 0);
  EXPECT_TRUE((out.iterations.array() == 25).all());
  EXPECT_TRUE((out.evaluations.array() == 26).all());
  EXPECT_EQ(out.stop, Stop::iterations);
  EXPECT_EQ(out.arrays.at("weight_change").rows(), 6);
  EXPECT_GT(out.arrays.at("weight_change").minCoeff(), 0);
}

// The state after the last step counts: with one step that improves, the best
// is what the step led to.
TEST(Jpo, TheLastStateCounts) {
  const auto jpo = jpo_fit({.step = AdamOptions{.rate = 1e-4}});
  StageBench bench(*jpo, kProblems, 1);
  const Outcome out = bench.run();
  const Batch<double> losses = bench.traced<double>(kProblems);
  ASSERT_EQ(losses.cols(), 2);
  EXPECT_LT(losses.col(1).sum(), losses.col(0).sum());
  EXPECT_TRUE(same_bits(bench.loss(out.x),
                        Vector<double>(losses.rowwise().minCoeff())));
}

TEST(Jpo, LowersTheLossInBothPrecisions) {
  const auto jpo = jpo_fit({.step = AdamOptions{.rate = 1e-2}});
  for (const auto precision : {Precision::f32, Precision::f64}) {
    StageBench bench(*jpo, kProblems, 400);
    const Outcome out = bench.run(nullptr, precision);
    const double first = bench.probe.curve().loss.col(0).mean();
    EXPECT_LT(bench.loss(out.x).mean(), 0.02 * first);
  }
}

// With outputs scaled by s the estimates are start + s N, so the same weights
// are that much farther from the start.
TEST(Jpo, ScalesTheOutput) {
  const auto jpo = jpo_fit();
  StageBench one(*jpo, kProblems, 0, quadratic(), quadratic_setting(1));
  StageBench two(*jpo, kProblems, 0, quadratic(), quadratic_setting(2));
  const Batch<double> a = one.run().x, b = two.run().x;
  const Batch<double> start = one.oracle.start();
  EXPECT_GT((a - start).norm(), 0);
  EXPECT_TRUE(Comparator(1e-14, 0)(b - start, 2 * (a - start)));

  // The chain rule knows the scale, and its sign.
  const auto scaled = jpo_fit({.step = AdamOptions{.rate = 1e-2}});
  StageBench bench(
      *scaled, kProblems, 300, quadratic(), quadratic_setting(-0.5));
  const Outcome out = bench.run();
  EXPECT_LT(bench.loss(out.x).mean(),
            0.1 * bench.probe.curve().loss.col(0).mean());
}

// One loss that is not finite does not spoil the others.
TEST(Jpo, SurvivesExamplesThatAreNotFinite) {
  const auto jpo = jpo_fit({.step = AdamOptions{.rate = 1e-3}});
  StageBench bench(*jpo, kProblems, 30, quadratic({.broken_above = 0.6}));
  const Outcome out = bench.run();
  const Batch<double> losses = bench.traced<double>(kProblems);
  EXPECT_FALSE(losses.allFinite());
  EXPECT_TRUE(out.x.allFinite());
  EXPECT_EQ(out.stop, Stop::iterations);
  EXPECT_EQ(losses.cols(), 31);
}

TEST(Jpo, StopsWhenNoLossIsFinite) {
  const auto jpo = jpo_fit();
  StageBench bench(*jpo, kProblems, 30, quadratic({.broken_above = -1e9}));
  const Outcome out = bench.run();
  EXPECT_EQ(out.stop, Stop::diverged);
  EXPECT_FALSE(out.message.empty());
  EXPECT_TRUE(out.x.allFinite());
  EXPECT_LE(bench.probe.iteration(), 1);
}

}  // namespace
}  // namespace physinv::test
