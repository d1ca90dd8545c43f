#include "optimizers/training/update_cosine.h"

#include <gtest/gtest.h>

#include "optimizers/training.h"
#include "problems/sine_plane/sine_plane.h"
#include "suite/core/any_problem.h"
#include "suite/nn/mlp.h"
#include "tests/support/bits.h"
#include "tests/support/memory_checkpoint.h"
#include "tests/support/quadratic.h"

namespace physinv::test {
namespace {

constexpr Index kCount = 12, kUpdates = 20;

const ProblemRecipe kSine = problems::sine_plane({.gamma = 2, .degrees = 30});
const Setting kSetting = {
    .predictor = {{Field::observations}, nn::mlp({.hidden = {16, 16}})},
    .surrogate = {}};

struct Trained {
  Outcome out;
  Curve curve;
};

Trained trained(const SignalRecipe& signal,
                const StepOptions& rule,
                Precision precision = Precision::f64,
                Checkpoint* checkpoint = nullptr) {
  const auto stage =
      train({.rule = rule, .batch = kCount, .fresh = true, .signal = signal});
  StageBench bench(*stage, kCount, kUpdates, kSine, kSetting);
  bench.checkpoint = checkpoint;
  Outcome out = bench.run(nullptr, precision);
  return {std::move(out), bench.probe.curve()};
}

TEST(UpdateCosine, LookingChangesNoBit) {
  for (const auto precision : {Precision::f32, Precision::f64}) {
    for (const auto norm : {ProxyNorm::square, ProxyNorm::absolute}) {
      const AdamOptions rule{.rate = 1e-2};
      const Trained plain = trained(inverse_proxy(norm), rule, precision);
      auto [out, curve] = trained(proxy_with_cosines(norm), rule, precision);
      const auto cosines = out.arrays.extract("update_cosine").mapped();
      EXPECT_EQ(cosines.size(), curve.points() - 1);
      EXPECT_LE(cosines.cwiseAbs().maxCoeff(), 1 + 1e-12);
      EXPECT_EQ(out.arrays, plain.out.arrays);
      EXPECT_TRUE(same_bits(curve.x, plain.curve.x));
    }
  }
}

TEST(UpdateCosine, SmallStepsOfDescentGoWhereTheInverseWants) {
  const auto cosines = [](double rate) {
    return trained(proxy_with_cosines(), SgdOptions{.rate = rate})
        .out.arrays.at("update_cosine");
  };
  const auto ahead = cosines(1e-3), back = cosines(-1e-3);
  EXPECT_GT(ahead.minCoeff(), 0);
  EXPECT_LT(back.maxCoeff(), 0);
  EXPECT_NEAR(ahead(0), -back(0), 1e-2);
  EXPECT_EQ(cosines(0).cwiseAbs().maxCoeff(), 0);
}

// By hand: the first update of descent.
TEST(UpdateCosine, IsThatOfTheMeans) {
  const double rate = 0.3;
  const auto stage = train({.rule = SgdOptions{.rate = rate},
                            .batch = kCount,
                            .signal = proxy_with_cosines()});
  StageBench bench(*stage, kCount, 1, kSine, kSetting);
  const double found = bench.run().arrays.at("update_cosine")(0, 0);

  Oracle oracle(kSine, kCount, bench.root, stage->needs());
  NetworkModel<double> model(kSetting.predictor, oracle.shape(), 2, nullptr);
  model.initialize(bench.root.child("network/init"));
  const Batch<double> y = oracle.training(0, kCount).y;
  const Batch<double> before = model.forward(y);
  Batch<double> there(2, kCount);
  Workspace work;
  AnyProblem<double>(problems::sine_plane({.gamma = 2, .degrees = 30}))
      .invert(y, Batch<double>(0, kCount), before, there, work);
  const Batch<double> dx = there - before;
  model.parameters() -= rate * model.backward(Batch<double>(-dx / kCount));
  const Batch<double> change = model.forward(y) - before;
  const Eigen::Vector2d a = change.rowwise().mean(), b = dx.rowwise().mean();
  EXPECT_NEAR(found, a.dot(b) / (a.norm() * b.norm()), 1e-10);
}

TEST(UpdateCosine, SurvivesACheckpoint) {
  for (const Index update : {2, 18}) {  // looked at, and not
    MemoryCheckpoint after(update);
    const auto found = [&](Checkpoint* checkpoint) {
      return trained(proxy_with_cosines(),
                     AdamOptions{.rate = 1e-2},
                     Precision::f32,
                     checkpoint)
          .out.arrays;
    };
    const auto once = found(nullptr);
    EXPECT_EQ(once, found(&after));
    EXPECT_EQ(after.at, update);
    EXPECT_EQ(once, found(&after));
    EXPECT_TRUE(after.restored);
  }
}

}  // namespace
}  // namespace physinv::test
