// Rules of curvature as stages: they learn, repeat themselves, end on NaN, and
// their parts do what they say.
#include <gtest/gtest.h>

#include "optimizers/training.h"
#include "optimizers/training/proxy.h"
#include "problems/exponential/exponential.h"
#include "suite/nn/mlp.h"
#include "tests/support/bits.h"
#include "tests/support/memory_checkpoint.h"
#include "tests/support/quadratic.h"

namespace physinv::test {
namespace {

Setting smooth_setting() {
  const auto net =
      nn::mlp({.hidden = {8, 8}, .activation = nn::Activation::tanh});
  return {.predictor = {{Field::observations}, net}, .surrogate = {}};
}

template <class Rule>
std::shared_ptr<const Stage> stage_of(const Rule& rule) {
  return train({.rule = rule, .batch = 16, .gradient_scale = 16});
}

constexpr AdaHessianOptions kAdaHessian{.rate = 1e-2};
constexpr HessianFreeOptions kHessianFree{.solver = {.iterations = 20}};

StageBench bench_of(const Stage& stage, Index updates) {
  return StageBench(
      stage, 16, updates, problems::exponential(), smooth_setting());
}

TEST(CurvatureRules, Learn) {
  for (const Precision p : {Precision::f32, Precision::f64}) {
    /// Last as part of the first.
    const auto left = [&](const auto& stage, Index updates) {
      StageBench bench = bench_of(*stage, updates);
      const Outcome out = bench.run(nullptr, p);
      EXPECT_EQ(out.stop, Stop::iterations);
      const Batch<double>& loss = out.arrays.at("batch_loss");
      return loss(0, updates - 1) / loss(0, 0);
    };
    EXPECT_LT(left(stage_of(kAdaHessian), 200), 0.01);
    EXPECT_LT(left(stage_of(kHessianFree), 20), 0.01);
  }
}

TEST(CurvatureRules, HessianFreeNeverRaisesTheObjective) {
  const auto stage = stage_of(kHessianFree);
  StageBench bench = bench_of(*stage, 6);
  const Outcome out = bench.run();
  const Batch<double>& before = out.arrays.at("objective");
  const Batch<double>& after = out.arrays.at("objective_after");
  ASSERT_EQ(before.size(), 6);
  EXPECT_TRUE((after.array() <= before.array()).all());
  EXPECT_EQ(before.rightCols(5), after.leftCols(5)) << "one batch";
  const Batch<double>& iterations = out.arrays.at("cg_iterations");
  EXPECT_GT(iterations.minCoeff(), 0);
  EXPECT_LE(iterations.maxCoeff(), 20);
}

TEST(CurvatureRules, RepeatThemselvesAlsoFromTheMiddle) {
  const auto expect_same = [](const auto& stage) {
    const auto found = [&](Checkpoint* checkpoint) {
      StageBench bench = bench_of(*stage, 5);
      bench.checkpoint = checkpoint;
      return bench.run(nullptr, Precision::f32).arrays;
    };
    MemoryCheckpoint after_two(2);
    const auto once = found(nullptr);
    EXPECT_EQ(once, found(&after_two));
    EXPECT_EQ(once, found(&after_two));
    EXPECT_TRUE(after_two.restored);
  };
  expect_same(stage_of(kAdaHessian));
  expect_same(stage_of(kHessianFree));
}

TEST(CurvatureRules, EndOnWhatIsNotFinite) {
  const auto expect_diverged = [](const auto& stage) {
    StageBench bench = bench_of(*stage, 4);
    Outcome before = bench.run();
    // The exponential overflows.
    before.arrays["parameters"].setConstant(1e200);
    StageBench again = bench_of(*stage, 4);
    const Outcome out = again.run(&before);
    EXPECT_EQ(out.stop, Stop::diverged);
    EXPECT_NE(out.message.find("update 1 "), std::string::npos) << out.message;
  };
  expect_diverged(stage_of(kAdaHessian));
  expect_diverged(stage_of(kHessianFree));
}

TEST(CurvatureRules, AskForWhatTheyNeed) {
  const Needs free = stage_of(kHessianFree)->needs();
  EXPECT_TRUE(contains(free, Needs::vjp | Needs::jvp));
  EXPECT_FALSE(contains(free, Needs::pullback_tangent));
  EXPECT_TRUE(contains(stage_of(kAdaHessian)->needs(),
                       Needs::vjp | Needs::jvp | Needs::pullback_tangent));
  EXPECT_ANY_THROW(train({.rule = kHessianFree, .signal = inverse_proxy()}));
  EXPECT_ANY_THROW(train({.rule = kAdaHessian, .chunk = 4}));
}

TEST(AdaHessianStep, AveragesTheTapsOfKernels) {
  const std::vector<TensorInfo> tensors = {
      {.kind = 'k', .offset = 0, .size = 6, .fan_in = 3, .fan_out = 6},
      {.kind = 'b', .offset = 6, .size = 2, .fan_in = 3, .fan_out = 6}};
  AdaHessian<double> rule({.rate = 0, .power = 1, .eps = 0}, tensors);
  Vector<double> x = Vector<double>::Ones(8), h(8);
  h << 1, -2, 3, -4, -5, 6, -7, 8;
  rule.step(x, x, h, x);
  Vector<double> want(8);
  want << 2, 2, 2, 5, 5, 5, 7, 8;
  EXPECT_EQ(h, want);
}

// x_1 = x - rate g / (|h|^power + eps)
TEST(AdaHessianStep, FirstStepIsByItsFormula) {
  const std::vector<TensorInfo> tensors = {
      {.kind = 'b', .offset = 0, .size = 1, .fan_in = 1, .fan_out = 1}};
  for (const double power : {0.5, 1.0}) {
    AdaHessian<double> rule({.rate = 0.1, .power = power, .eps = 0.5}, tensors);
    Vector<double> x = Vector<double>::Constant(1, 3.0), h = -4 * x / 3;
    rule.step(x, Vector<double>::Constant(1, 2.0), h, x);
    EXPECT_NEAR(x(0), 3 - 0.1 * 2 / (std::pow(4, power) + 0.5), 1e-15);
  }
}

TEST(ConjugateGradients, SolveAndStoreBySchedule) {
  constexpr Index n = 60;
  Vector<double> diagonal(n), b(n);
  for (Index i = 0; i < n; ++i)
    diagonal(i) = 1 + double(i), b(i) = std::sin(double(i) + 1);
  const auto product = [&](const Vector<double>& d, Vector<double>& a_d) {
    a_d = diagonal.cwiseProduct(d);
  };
  const auto path = conjugate_gradients(
      product,
      b,
      Vector<double>::Zero(n),
      {.iterations = 200, .progress = 0, .residual = 1e-10});
  const Vector<double> exact = b.cwiseQuotient(diagonal);
  EXPECT_LT((path.stored.back().second - exact).norm(), 1e-10 * exact.norm());
  EXPECT_NEAR(path.model.back(), -0.5 * b.dot(exact), 1e-12);
  std::vector<Index> stored;
  for (const auto& [i, s] : path.stored) stored.push_back(i);
  const std::vector<Index> schedule = {0, 1, 2, 3, 4, 6, 8, 10, 13, 17, 23};
  ASSERT_GT(stored.size(), schedule.size());
  stored.resize(schedule.size());
  EXPECT_EQ(stored, schedule);
  // Without progress, no earlier than after ten iterations.
  const auto ended = conjugate_gradients(
      product, b, Vector<double>::Zero(n), {.progress = 1, .residual = 0});
  EXPECT_EQ(ended.iterations(), 11);
  EXPECT_EQ(ended.stored.back().first, 11);
  // Nothing to solve.
  EXPECT_EQ(conjugate_gradients(product, 0 * b, 0 * b, {}).iterations(), 0);
}

TEST(ConjugateGradients, PowersOfTwoChangeNoBit) {
  constexpr Index n = 20;
  Vector<double> diagonal(n), b(n);
  for (Index i = 0; i < n; ++i)
    diagonal(i) = 1 + double(i), b(i) = std::sin(double(i) + 1);
  const auto product = [&](const Vector<double>& d, Vector<double>& a_d) {
    a_d = diagonal.cwiseProduct(d);
  };
  const auto path = conjugate_gradients(product, b, 0.1 * b, {});
  ASSERT_GT(path.iterations(), 3);
  for (const int e : {-900, -560, -100, 100, 560, 900}) {
    const double size = std::ldexp(1.0, e);
    const auto far = conjugate_gradients(product, size * b, size * 0.1 * b, {});
    ASSERT_EQ(far.iterations(), path.iterations()) << e;
    ASSERT_EQ(far.stored.size(), path.stored.size());
    for (std::size_t k = 0; k < path.stored.size(); ++k) {
      EXPECT_EQ(far.stored[k].first, path.stored[k].first);
      EXPECT_TRUE(same_bits(far.stored[k].second,
                            Vector<double>(size * path.stored[k].second)));
    }
  }
}

}  // namespace
}  // namespace physinv::test
