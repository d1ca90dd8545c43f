#include "baselines/supervised.h"

#include <gtest/gtest.h>

#include "baselines/prior_guess.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "tests/support/bits.h"
#include "tests/support/quadratic.h"

namespace physinv::test {
namespace {

constexpr Index kExamples = 24;

double training_loss(const Outcome& out) {
  return out.arrays.at("training_loss")(0, 0);
}

TEST(Supervised, LearnsAndGeneralises) {
  const auto stage = supervised_fit({.step = AdamOptions{.rate = 1e-2}});
  for (const auto precision : {Precision::f32, Precision::f64}) {
    StageBench first(*stage, kExamples, 1), bench(*stage, kExamples, 600);
    const double before = training_loss(first.run(nullptr, precision));
    const Outcome out = bench.run(nullptr, precision);
    EXPECT_LT(training_loss(out), 0.05 * before);
    EXPECT_LT(bench.loss(out.x).mean(),
              0.3 * bench.probe.curve().loss.col(0).mean());
    EXPECT_TRUE((out.iterations.array() == 600).all());
  }
}

TEST(PriorGuess, IsTheSolutionOfOtherProblems) {
  const auto stage = prior_guess();
  StageBench bench(*stage, kExamples, 0);
  const Outcome out = bench.run();
  EXPECT_TRUE(same_bits(out.x, bench.oracle.labelled().x));
  EXPECT_FALSE(same_bits(out.x, bench.oracle.data().x));
  EXPECT_EQ(bench.probe.curve().points(), 1);
  EXPECT_EQ(bench.oracle.counts()[Counter::forward], 0U);
}

// The prediction of the last network, be it better or worse than before.
TEST(Supervised, SelectsNoBestIterate) {
  const auto stage = supervised_fit({.step = AdamOptions{.rate = 0.3}});
  StageBench bench(*stage, kExamples, 60);
  const Outcome out = bench.run();
  const Batch<double>& curve = bench.probe.curve().loss;
  const Vector<double> last = curve.rightCols(1);
  EXPECT_TRUE(same_bits(bench.loss(out.x), last));
  EXPECT_GT((last - curve.rowwise().minCoeff()).maxCoeff(), 0);
}

// More samples than problems: batches of the training set, all of them seen in
// every pass, in another order each time.
TEST(Supervised, GoesThroughItsSetInParts) {
  const auto stage = supervised_fit({.step = AdamOptions{.rate = 1e-2}});
  StageBench few(*stage, kExamples, 400), many(*stage, kExamples, 400);
  many.setting.labels.per_problem = 4;
  const Outcome a = few.run(), b = many.run();
  EXPECT_EQ(many.oracle.labelled(4).count(), 4 * kExamples);
  EXPECT_LT(many.loss(b.x).mean(), many.probe.curve().loss.col(0).mean());
  EXPECT_FALSE(same_bits(a.x, b.x));
}

// Bounded unknowns are learnt as tanh x.
TEST(Supervised, BoundedUnknownsAreLearntAsTheyAreRead) {
  const auto stage = supervised_fit({.step = AdamOptions{.rate = 1e-2}});
  StageBench first(*stage, kExamples, 1), bench(*stage, kExamples, 600);
  for (StageBench* b : {&first, &bench}) b->setting.labels.bounded = 1;
  const double before = training_loss(first.run());
  const Outcome out = bench.run();
  EXPECT_LT(training_loss(out), 0.1 * before);
  EXPECT_LT(bench.loss(out.x).mean(), bench.probe.curve().loss.col(0).mean());
}

/// The same labelled samples, other problems.
template <class T>
class OtherProblems final : public GradientQuadratic<T> {
 public:
  using GradientQuadratic<T>::GradientQuadratic;
  void draw(Stream& stream, SampleOut& sample) const override {
    GradientQuadratic<T>::draw(stream, sample);
    if (!sample.labelled) sample.given *= 2;
  }
};

// Nothing of the problems it is asked about enters the training: neither
// simulations nor gradients are made, and other problems leave the weights.
TEST(Supervised, SeesOnlyTheLabelledSamples) {
  const auto stage = supervised_fit();
  StageBench bench(*stage, kExamples, 20);
  const Outcome out = bench.run();
  const Counts& counts = bench.oracle.counts();
  EXPECT_EQ(counts[Counter::forward], 0U);
  EXPECT_EQ(counts[Counter::vjp], 0U);
  EXPECT_EQ(counts[Counter::network_forward],
            static_cast<std::uint64_t>(20 * kExamples));
  StageBench other(*stage, kExamples, 20, problem<OtherProblems>("quadratic"));
  const Outcome on_other = other.run();
  EXPECT_FALSE(same_bits(on_other.x, out.x));
  EXPECT_TRUE(same_bits(on_other.arrays.at("weight_change"),
                        out.arrays.at("weight_change")));
  EXPECT_EQ(training_loss(on_other), training_loss(out));
}

TEST(Supervised, TargetsAreScaledLikeTheOutput) {
  const auto stage = supervised_fit({.step = AdamOptions{.rate = 1e-2}});
  StageBench bench(*stage, kExamples, 600, quadratic(), quadratic_setting(0.5));
  const Outcome out = bench.run();
  EXPECT_LT(bench.loss(out.x).mean(),
            0.05 * bench.probe.curve().loss.col(0).mean());
}

}  // namespace
}  // namespace physinv::test
