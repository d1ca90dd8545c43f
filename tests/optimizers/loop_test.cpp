// The loop itself, by signals and rules that note what it asks of them.
#include "optimizers/training/loop.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

#include "optimizers/training.h"
#include "optimizers/training/batch_signal.h"
#include "optimizers/training/first_order.h"
#include "suite/core/oracle.h"
#include "tests/support/bits.h"
#include "tests/support/quadratic.h"

namespace physinv::test {
namespace {

constexpr Index kProblems = 12, kUpdates = 4;

/// Parameters go down by `pull`, whatever they are.
class Falling final : public Signal<double> {
 public:
  explicit Falling(NetworkModel<double>& model) : model_(model) {}

  bool evaluate(bool last) override {
    evaluations.push_back(last);
    return static_cast<Index>(evaluations.size()) <= patience;
  }
  Vector<double>& gradient() override {
    ++gradients;
    gradient_.setConstant(model_.parameters().size(), pull);
    return gradient_;
  }

  void serialize(Archive&) override {}

  Index patience = 100, gradients = 0;
  double pull = 1;
  std::vector<bool> evaluations;

 private:
  NetworkModel<double>& model_;
  Vector<double> gradient_;
};

struct LoopBench {
  LoopBench()
      : stage(train({.rule = SgdOptions{}})),
        bench(*stage, kProblems, kUpdates),
        run{.oracle = bench.oracle,
            .probe = bench.probe,
            .setting = bench.setting,
            .previous = nullptr,
            .network_init = bench.root.child("network/init"),
            .batches = bench.root.child("batches"),
            .method = bench.root.child("method"),
            .iterations = kUpdates,
            .precision = Precision::f64,
            .threads = nullptr},
        model(bench.setting.predictor, bench.oracle.shape(), 2, nullptr),
        signal(model) {
    model.initialize(run.network_init);
  }
  Outcome train_by(Rule<double>& rule) {
    return run_training<double>(
        {.model = model,
         .signal = signal,
         .rule = rule,
         .batches = nullptr,
         .estimate = [&](BatchOut<double> x) { x = bench.oracle.start(); }},
        run);
  }

  std::shared_ptr<const Stage> stage;
  StageBench bench;
  StageRun run;
  NetworkModel<double> model;
  Falling signal;
};

TEST(Loop, LooksBeforeEveryUpdateAndAfterTheLast) {
  LoopBench b;
  FirstOrder<double> rule(SgdOptions{.rate = 0.5}, b.model);
  const Vector<double> before = b.model.parameters();
  const Outcome out = b.train_by(rule);
  EXPECT_EQ(b.signal.evaluations,
            (std::vector<bool>{false, false, false, false, true}));
  EXPECT_EQ(b.signal.gradients, kUpdates);
  EXPECT_LT((before.array() - 0.5 * kUpdates - b.model.parameters().array())
                .abs()
                .maxCoeff(),
            1e-14);
  EXPECT_EQ(out.stop, Stop::iterations);
  EXPECT_TRUE((out.iterations.array() == kUpdates).all());
}

TEST(Loop, EndsWhenTheSignalSeesNothing) {
  LoopBench b;
  b.signal.patience = 2;
  FirstOrder<double> rule(SgdOptions{}, b.model);
  const Outcome out = b.train_by(rule);
  EXPECT_EQ(out.stop, Stop::diverged);
  EXPECT_EQ(out.message, "no finite loss after iteration 2");
  EXPECT_EQ(b.signal.gradients, 2);
}

TEST(Loop, AGuardedRuleKeepsTheParametersAnOtherDoesNot) {
  for (const bool guarded : {true, false}) {
    LoopBench b;
    b.signal.pull = std::numeric_limits<double>::infinity();
    const Vector<double> before = b.model.parameters();
    FirstOrder<double> plain(SgdOptions{}, b.model);
    GuardedFirstOrder<double> careful(SgdOptions{}, b.model);
    const Outcome out = guarded ? b.train_by(careful) : b.train_by(plain);
    EXPECT_EQ(same_bits(b.model.parameters(), before), guarded);
    EXPECT_EQ(out.stop, guarded ? Stop::diverged : Stop::iterations);
    EXPECT_EQ(b.signal.gradients, guarded ? 1 : kUpdates);
  }
}

/// What an inverse proposes, x' = A^-1 (y - given), as a proxy objective
/// 1/2 |x - x'|^2: all that another method of training has to say.
template <class T>
class Proxy final : public BatchSignal<T> {
 public:
  using BatchSignal<T>::BatchSignal;

 private:
  void push(BatchIn<T> x,
            Index first,
            VectorOut<double> loss,
            BatchOut<T> x_bar) override {
    const auto y = this->batches_.target(first, x.cols());
    const auto given = this->batches_.given(first, x.cols());
    x_bar = x - Quadratic<T>::matrix().inverse() * (y - given);
    loss = 0.5 * x_bar.colwise().squaredNorm().template cast<double>();
    x_bar *= this->factor_;
  }
};

TEST(Loop, AnotherSignalIsOneFunction) {
  TrainingOptions options{.rule = AdamOptions{.rate = 1e-2}, .batch = 16};
  options.fresh = true;
  options.signal = batch_signal<Proxy>("proxy", Needs::forward, Needs::forward);
  const auto stage = train(options);
  EXPECT_EQ(stage->options().front().second, "proxy");
  EXPECT_FALSE(contains(stage->needs(), Needs::vjp));
  for (const auto precision : {Precision::f32, Precision::f64}) {
    StageBench bench(*stage, kProblems, 400);
    const Outcome out = bench.run(nullptr, precision);
    const auto& mean = out.arrays.at("mean_loss");
    EXPECT_LT(mean(mean.size() - 1), 0.05 * mean(0));
    const auto& batch = out.arrays.at("batch_loss");
    EXPECT_LT(batch(batch.size() - 1), 0.05 * batch(0));
  }

  // Jacobians follow; a rule that wants products with second derivatives gets
  // an error that there are none.
  options.rule = HalfInverseStepOptions{};
  const auto other = train(options);
  StageBench bench(*other, kProblems, 1);
  EXPECT_EQ(bench.run().stop, Stop::iterations);
  options.rule = HessianFreeOptions{};
  EXPECT_THROW(train(options), std::exception);
}

}  // namespace
}  // namespace physinv::test
