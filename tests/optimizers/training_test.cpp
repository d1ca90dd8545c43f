#include "optimizers/training.h"

#include <gtest/gtest.h>

#include "optimizers/rate_search.h"
#include "optimizers/training/label_loss.h"
#include "suite/core/clock.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "tests/support/bits.h"
#include "tests/support/memory_checkpoint.h"
#include "tests/support/quadratic.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

constexpr Index kCount = 12;

TrainingOptions adam(Index batch) {
  return {.rule = AdamOptions{.rate = 1e-2}, .batch = batch};
}

TEST(Training, LowersTheLossOfProblemsItDoesNotSee) {
  for (const auto precision : {Precision::f32, Precision::f64}) {
    for (const bool fresh : {false, true}) {
      auto options = adam(16);
      options.fresh = fresh;
      const auto stage = train(options);
      StageBench bench(*stage, 64, 400);
      const Outcome out = bench.run(nullptr, precision);
      const auto& mean = out.arrays.at("mean_loss");
      EXPECT_LT(mean(mean.size() - 1), 0.05 * mean(0));
      EXPECT_NEAR(mean(mean.size() - 1), bench.loss(out.x).mean(), 1e-12);
      EXPECT_EQ(out.arrays.at("batch_loss").size(), 400);
      EXPECT_EQ(out.arrays.at("samples_drawn")(0, 0), 400 * 16);
    }
  }
}

// One epoch of batches is one pass over the set, in order; the remainder is
// left out. Plain descent on the whole set by hand gives the same weights, in
// however many parts a batch is taken.
void expect_gradient_descent(Index chunk) {
  const auto stage =
      train({.rule = SgdOptions{.rate = 0.1}, .batch = kCount, .chunk = chunk});
  StageBench bench(*stage, kCount, 3);
  const Outcome out = bench.run();

  const Setting setting = quadratic_setting();
  Oracle oracle(quadratic(), kCount, bench.root, stage->needs());
  NetworkModel<double> model(setting.predictor, oracle.shape(), 2, nullptr);
  model.initialize(bench.root.child("network/init"));
  const Samples<double> data = oracle.training(0, kCount);
  const Batch<double> start = oracle.start();
  const Batch<double> input =
      assemble<double>(setting.predictor.inputs, start, data.given, data.y);
  const Quadratic<double> problem;
  Workspace work;
  Tape tape;
  for (int k = 0; k < 3; ++k) {
    const Batch<double> x = start + model.forward(input);
    Batch<double> y(2, kCount), x_bar(2, kCount);
    problem.forward({x, data.given}, y, work);
    problem.pullback(tape, (y - data.y) / kCount, x_bar, work);
    model.parameters() -= 0.1 * model.backward(x_bar);
  }
  EXPECT_TRUE(Comparator(1e-12, 1e-14)(
      Vector<double>(out.arrays.at("parameters").col(0)),
      Vector<double>(model.parameters())));
}

TEST(Training, WholeBatchesAreGradientDescentOnTheMeanLoss) {
  for (const Index chunk : {Index{0}, Index{5}, Index{6}, kCount}) {
    SCOPED_TRACE(chunk);
    expect_gradient_descent(chunk);
  }
}

// By hand, too; no simulation is made.
TEST(Training, LabelsPullTheEstimatesToTheSolutions) {
  const auto stage = train({.rule = SgdOptions{.rate = 0.1},
                            .batch = kCount,
                            .signal = label_loss()});
  EXPECT_TRUE(contains(stage->needs(), Needs::labels));
  EXPECT_FALSE(contains(stage->needs(), Needs::vjp));
  StageBench bench(*stage, kCount, 3);
  const Outcome out = bench.run();
  EXPECT_EQ(bench.oracle.counts()[Counter::vjp], 0U);
  EXPECT_EQ(bench.oracle.counts()[Counter::forward], 0U);

  const Setting setting = quadratic_setting();
  Oracle oracle(quadratic(), kCount, bench.root, stage->needs());
  NetworkModel<double> model(setting.predictor, oracle.shape(), 2, nullptr);
  model.initialize(bench.root.child("network/init"));
  const Samples<double> data = oracle.labelled(0, kCount);
  const Batch<double> start = oracle.start();
  const Batch<double> input =
      assemble<double>(setting.predictor.inputs, start, data.given, data.y);
  for (int k = 0; k < 3; ++k) {
    const Batch<double> away = start + model.forward(input) - data.x;
    EXPECT_NEAR(out.arrays.at("batch_loss")(0, k),
                0.5 * away.squaredNorm() / kCount,
                1e-12);
    model.parameters() -= 0.1 * model.backward(Batch<double>(away / kCount));
  }
  EXPECT_TRUE(Comparator(1e-12, 1e-14)(
      Vector<double>(out.arrays.at("parameters").col(0)),
      Vector<double>(model.parameters())));
}

TEST(Training, BatchesAreSlicesInOrder) {
  // With a rate of zero the losses are those of the untrained network, so the
  // third batch of five out of twelve is the first again.
  const auto stage = train({.rule = SgdOptions{.rate = 0}, .batch = 5});
  StageBench bench(*stage, kCount, 4);
  const auto losses = bench.run().arrays.at("batch_loss");
  EXPECT_EQ(losses(0), losses(2));
  EXPECT_EQ(losses(1), losses(3));
  EXPECT_NE(losses(0), losses(1));
}

// As if the case had that many problems.
TEST(Training, ASetMayHaveASizeOfItsOwn) {
  const auto parameters = [](Index problems, Index set) {
    auto options = adam(4);
    options.set = set;
    const auto stage = train(options);
    StageBench bench(*stage, problems, 7);
    return Batch<double>(bench.run().arrays.at("parameters"));
  };
  EXPECT_TRUE(same_bits(parameters(3, 8), parameters(8, 0)));
  EXPECT_FALSE(same_bits(parameters(3, 8), parameters(3, 0)));
}

TEST(Training, ChainsContinue) {
  const auto stage = train(adam(4));
  StageBench first(*stage, kCount, 5), second(*stage, kCount, 0);
  const Outcome before = first.run();
  const Outcome after = second.run(&before);
  EXPECT_TRUE(same_bits(before.x, after.x));
  EXPECT_EQ(after.arrays.at("samples_drawn")(0, 0), 20);
}

TEST(Training, GoesOnFromTheMiddle) {
  std::vector<TrainingOptions> all;
  for (const StepOptions& step : std::initializer_list<StepOptions>{
           AdamOptions{.rate = 1e-2},
           SgdOptions{.rate = 1e-2, .momentum = 0.9},
           AdagradOptions{.rate = 1e-2},
           AdadeltaOptions{.rate = 1},
           RmspropOptions{.rate = 1e-2}})
    all.push_back({.rule = step, .batch = 4});
  all.push_back({.rule = HalfInverseStepOptions{}, .batch = 4});
  TrainingOptions fresh = adam(5);
  fresh.fresh = true;
  fresh.chunk = 2;
  fresh.late = {.name = "late", .share = 0.9, .of = [](auto x, auto) {
                  return x.squaredNorm();
                }};
  all.push_back(fresh);
  for (const TrainingOptions& options : all) {
    const auto stage = train(options);
    SCOPED_TRACE(stage->options()[5].second);
    for (const auto precision : {Precision::f32, Precision::f64}) {
      const auto found = [&](Checkpoint* checkpoint) {
        StageBench bench(*stage, kCount, 20);
        bench.checkpoint = checkpoint;
        auto arrays = bench.run(nullptr, precision).arrays;
        arrays[ArrayKey::own("curve")] = bench.probe.curve().x;
        return arrays;
      };
      MemoryCheckpoint after(11);
      const auto once = found(nullptr);
      EXPECT_EQ(once, found(&after));
      EXPECT_EQ(after.at, 11);
      EXPECT_EQ(once, found(&after));
      EXPECT_TRUE(after.restored);
    }
  }
}

TEST(Training, ALaidDownStateOfAnotherTrainingIsRefused) {
  MemoryCheckpoint after(1);
  const auto one = train(adam(4)), other = train({.rule = SgdOptions{}});
  StageBench first(*one, kCount, 3), second(*other, kCount, 3);
  first.checkpoint = second.checkpoint = &after;
  first.run();
  EXPECT_THROW(second.run(), ContractError);
}

TEST(Training, MetricsAreTakenAtEveryPointOfTheCurve) {
  auto options = adam(4);
  options.metrics = {
      .name = "mean_y",
      .rows = {"y0", "iteration"},
      .evaluate = [](const Snapshot& s, VectorOut<double> values) {
        values << s.y.row(0).mean(), static_cast<double>(s.iteration);
      }};
  const auto stage = train(options);
  StageBench bench(*stage, kCount, 30);
  const auto metrics = bench.run().arrays.at("metrics");
  const Curve& curve = bench.probe.curve();
  ASSERT_EQ(metrics.cols(), curve.points());
  for (Index k = 0; k < curve.points(); ++k)
    EXPECT_EQ(metrics(1, k), curve.iteration[static_cast<std::size_t>(k)]);
}

TEST(Training, AnUpdateThatOverflowsIsNotTaken) {
  const auto stage = train({.rule = SgdOptions{.rate = 1e300}, .batch = 4});
  StageBench bench(*stage, kCount, 50);
  const Outcome out = bench.run();
  EXPECT_EQ(out.stop, Stop::diverged);
  EXPECT_FALSE(out.message.empty());
  EXPECT_LT(bench.probe.iteration(), 50);
  for (const auto& [name, array] : out.arrays)
    EXPECT_TRUE(array.allFinite()) << name;
}

TEST(Training, ARowSetsTheLengthUnlessTheStageKeepsItsOwn) {
  auto options = adam(4);
  EXPECT_TRUE(train(options)->takes_row_iterations());
  options.iterations = 7;
  options.own_length = true;
  EXPECT_FALSE(train(options)->takes_row_iterations());
  EXPECT_EQ(train(options)->default_iterations(), 7);
}

// A recipe that takes long to make: it is made again for every draw.
/// Draws for two milliseconds.
template <class T>
class SlowToDraw final : public GradientQuadratic<T> {
 public:
  using GradientQuadratic<T>::GradientQuadratic;
  void draw(Stream& stream, SampleOut& sample) const override {
    const double begun = now().cpu;
    while (now().cpu < begun + 2e-3) {
    }
    GradientQuadratic<T>::draw(stream, sample);
  }
};

TEST(Training, DrawingFreshSamplesHasItsOwnClock) {
  auto options = adam(4);
  options.fresh = true;
  const auto stage = train(options);
  StageBench bench(*stage, kCount, 40, problem<SlowToDraw>("quadratic"));
  bench.run();
  const Clocks clocks = bench.probe.clocks();
  EXPECT_GE(clocks.data.cpu, 40 * 2e-3);
  EXPECT_LT(clocks.solve.cpu, clocks.data.cpu / 2);
}

TEST(RateSearch, IsTrainingAtTheRateThatEndsLowest) {
  const TrainingOptions options{
      .rule = SgdOptions{}, .batch = kCount, .fresh = true};
  // The last rate is beyond what the quadratic bears.
  const auto tuned =
      train_at_best_rate(options, {.rates = {1e-4, 1e-1, 1e3}, .share = 0.5});
  StageBench bench(*tuned, kCount, 40);
  const Outcome out = bench.run();
  EXPECT_EQ(out.arrays.at("rate")(0, 0), 1e-1);
  const auto& loss = out.arrays.at("searched_loss");
  EXPECT_LT(loss(1), loss(0));
  EXPECT_LT(loss(0), loss(2));

  TrainingOptions plain = options;
  plain.rule = SgdOptions{.rate = 1e-1};
  const auto stage = train(plain);
  StageBench same(*stage, kCount, 40);
  const Outcome expected = same.run();
  EXPECT_EQ(out.x, expected.x);
  EXPECT_EQ(out.arrays.at("parameters"), expected.arrays.at("parameters"));
}

}  // namespace
}  // namespace physinv::test
