#include "optimizers/classical.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "optimizers/minimize.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "tests/support/bits.h"
#include "tests/support/quadratic.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

constexpr Index kCount = 9;

TEST(Classical, FindsTheOptimumOfAQuadratic) {
  // Of L-BFGS-B two meet the tolerance of the loss and not that of the
  // gradient.
  const std::pair<std::shared_ptr<const Stage>, Index> ends_by_loss[] = {
      {bfgs_solve(), 0}, {lbfgsb_solve(), 2}, {gradient_descent_solve(), 0}};
  for (const auto& [stage, by_loss] : ends_by_loss) {
    StageBench bench(*stage, kCount, 1000);
    const Outcome out = bench.run();
    SCOPED_TRACE(stage->options().front().second);
    EXPECT_EQ(out.stop, Stop::converged);
    EXPECT_TRUE(Comparator(0, 1e-4)(out.x, bench.oracle.data().x));
    EXPECT_LT(bench.loss(out.x).maxCoeff(), 1e-8);
    EXPECT_EQ(std::ranges::count(out.status, Status::ftol), by_loss);
    EXPECT_EQ(std::ranges::count(out.status, Status::gtol), kCount - by_loss);
  }
}

TEST(Classical, InFloatLossesAreRoundedAndTheToleranceIsItsOwn) {
  const auto in_double = bfgs_solve({.gtol = 1e-3});
  const auto in_float = bfgs_solve({.gtol = 1e-3, .single = true});
  StageBench one(*in_double, kCount, 1000), other(*in_float, kCount, 1000);
  const Outcome exact = one.run(), rounded = other.run();
  EXPECT_FALSE(exact.arrays.contains("own_loss"));
  ASSERT_TRUE(rounded.arrays.contains("own_loss"));
  const Batch<double>& own = rounded.arrays.at("own_loss");
  ASSERT_EQ(own.cols(), kCount);
  const Vector<double> loss = other.loss(rounded.x);
  for (Index i = 0; i < kCount; ++i) {
    EXPECT_EQ(own(0, i), static_cast<double>(static_cast<float>(own(0, i))));
    EXPECT_NEAR(own(0, i), loss(i), 1e-5 * (1 + loss(i)));
  }
  EXPECT_FALSE(same_bits(exact.x, rounded.x));
  const auto strict = bfgs_solve({.gtol = 1e-9});
  StageBench third(*strict, kCount, 1000);
  EXPECT_GT(third.run().iterations.sum(), exact.iterations.sum());
}

TEST(Classical, FirstStepsAreAsLongAsAsked) {
  const auto length_of = [](const std::shared_ptr<const Stage>& stage) {
    StageBench bench(*stage, kCount, 1);
    return bench.run().arrays.at("first_step").maxCoeff();
  };
  // The adaptive rule stretches a step a thousandfold at most, the bold driver
  // takes it as it is.
  const double adaptive = length_of(gradient_descent_solve());
  EXPECT_LT(length_of(gradient_descent_solve({.first_step = 1e-9})),
            1e-4 * adaptive);
  const double bold = length_of(bold_descent_solve());
  EXPECT_NEAR(
      length_of(bold_descent_solve({.first_step = 0.05})), bold / 2, 1e-12);
  EXPECT_THROW(gradient_descent_solve({.first_step = 0}), std::logic_error);
  EXPECT_THROW(bold_descent_solve({.first_step = -1}), std::logic_error);
}

TEST(Classical, CurvesStartAtTheStartAndEndAtTheResult) {
  for (const auto& stage :
       {bfgs_solve(), lbfgsb_solve(), gradient_descent_solve()}) {
    StageBench bench(*stage, kCount, 1000);
    const Outcome out = bench.run();
    const Curve& curve = bench.probe.curve();
    EXPECT_TRUE(same_bits(Vector<double>(curve.loss.col(0)),
                          bench.loss(bench.oracle.start())));
    EXPECT_TRUE(
        same_bits(Vector<double>(curve.loss.rightCols(1)), bench.loss(out.x)));
    EXPECT_EQ(curve.iteration.back(), out.iterations.maxCoeff());
    for (Index k = 1; k < curve.points(); ++k)
      EXPECT_TRUE(
          (curve.loss.col(k).array() <= curve.loss.col(k - 1).array()).all());
  }
}

TEST(Classical, CountsTheEvaluationsMade) {
  const auto bfgs = bfgs_solve();
  StageBench bench(*bfgs, kCount, 1000);
  const Outcome out = bench.run();
  EXPECT_EQ(bench.oracle.counts()[Counter::vjp],
            static_cast<std::uint64_t>(out.evaluations.sum()));
  const auto lbfgsb = lbfgsb_solve();
  StageBench limited(*lbfgsb, kCount, 1000);
  const double made = limited.run().evaluations.sum();
  EXPECT_EQ(static_cast<double>(limited.oracle.counts()[Counter::vjp]), made);
  EXPECT_GT(limited.oracle.counts()[Counter::skipped_forward], 0U);
  const auto gd = gradient_descent_solve();
  StageBench descent(*gd, kCount, 1000);
  const Outcome end = descent.run();
  const Counts counts = descent.oracle.counts();
  EXPECT_EQ(counts[Counter::vjp] + counts[Counter::skipped_trials],
            static_cast<std::uint64_t>(end.evaluations.sum()));
}

TEST(Classical, RefinesWhatTheStageBeforeLeft) {
  const auto refine = bfgs_refine();
  StageBench bench(*refine, kCount, 1000), solved(*refine, kCount, 1000);
  Outcome previous;
  previous.x = bench.oracle.start().array() + 0.25;
  const Outcome out = bench.run(&previous);
  EXPECT_TRUE(same_bits(Vector<double>(bench.probe.curve().loss.col(0)),
                        bench.loss(previous.x)));
  EXPECT_EQ(out.stop, Stop::converged);
  // From a solution there is nothing to do.
  const Outcome again = solved.run(&out);
  EXPECT_TRUE(same_bits(again.x, out.x));
  EXPECT_TRUE((again.iterations.array() == 0).all());
}

TEST(Classical, AStartThatIsNotFiniteStaysWithItsStatus) {
  const ProblemRecipe broken = quadratic({.broken_above = 5});
  for (const bool refines : {true, false}) {
    const auto stage = refines ? bfgs_refine() : gradient_descent_solve();
    StageBench bench(*stage, kCount, 50, broken);
    Outcome previous;
    previous.x = bench.oracle.start();
    if (refines) previous.x(0, 2) = 6;
    const Outcome out = bench.run(&previous);
    EXPECT_TRUE(out.x.allFinite());
    const auto expected = refines ? Status::nonfinite : Status::gtol;
    EXPECT_EQ(out.status[2], expected);
    EXPECT_EQ(out.status[3], Status::gtol);
    if (!refines) continue;
    EXPECT_EQ(out.x(0, 2), 6);
    EXPECT_EQ(out.stop, Stop::iterations);
    // No number was measured, so none may be in the curve.
    const Curve& curve = bench.probe.curve();
    EXPECT_TRUE(curve.loss.row(2).array().isNaN().all());
    EXPECT_TRUE(Batch<double>(curve.loss.row(3)).allFinite());
  }
}

TEST(Classical, ObeysItsIterations) {
  for (const auto& stage :
       {bfgs_solve(), lbfgsb_solve(), gradient_descent_solve()}) {
    for (const Index most : {0, 1, 2}) {
      StageBench bench(*stage, kCount, most);
      const Outcome out = bench.run();
      EXPECT_LE(out.iterations.maxCoeff(), static_cast<double>(most));
      EXPECT_EQ(out.stop, Stop::iterations);
    }
  }
}

TEST(Classical, StagesNameThemselves) {
  EXPECT_EQ(bfgs_solve()->name(), "solve");
  EXPECT_EQ(bfgs_refine()->name(), "refine");
  EXPECT_EQ(bfgs_solve({.iterations = 7})->default_iterations(), 7);
  EXPECT_TRUE(bfgs_solve()->takes_row_iterations());
  EXPECT_FALSE(bfgs_refine()->takes_row_iterations());
  EXPECT_NE(bfgs_solve()->options(), bfgs_refine()->options());
  EXPECT_NE(lbfgsb_solve({.lower = {0}})->options(), lbfgsb_solve()->options());
}

/// x -= g / 2 until no problem has a gradient left.
class HalfSteps final : public BatchedSolver {
 public:
  void start(BatchIn<double> x0) override { open(x0); }

 private:
  void take(VectorIn<double> loss, BatchIn<double> gradient) override {
    std::size_t kept = 0;
    for (std::size_t at = 0; at < active_.size(); ++at) {
      const Index i = active_[at];
      const auto g = gradient.col(static_cast<Index>(at));
      x_.col(i) = trial_.col(static_cast<Index>(at));
      loss_(i) = loss(static_cast<Index>(at));
      gradient_.col(i) = g;
      iterations_[static_cast<std::size_t>(i)] = rounds_;
      accepted_.push_back(i);
      if (g.lpNorm<Eigen::Infinity>() <= 1e-6) {
        finish(i, Status::gtol);
      } else {
        trial_.col(static_cast<Index>(kept)) = x_.col(i) - g / 2;
        active_[kept++] = i;
      }
    }
    active_.resize(kept);
  }
};

TEST(Classical, ASolverFromOutsideIsAStage) {
  const auto stage = make_stage(
      {.name = "solve",
       .needs = Needs::forward | Needs::vjp,
       .options = Options{{"algorithm", "half steps"}},
       .iterations = 100,
       .networks = Networks::none,
       .operations =
           [](const CaseSize& size) { return size.problem_operations; }},
      [](StageRun& run) {
        HalfSteps solver;
        return minimize(solver, run, run.oracle.start());
      });
  EXPECT_FALSE(stage->has_precision());
  StageBench bench(*stage, kCount, 100);
  const Outcome out = bench.run();
  EXPECT_EQ(out.stop, Stop::converged);
  EXPECT_TRUE(Comparator(0, 1e-4)(out.x, bench.oracle.data().x));
  EXPECT_EQ(bench.oracle.counts()[Counter::vjp],
            static_cast<std::uint64_t>(out.evaluations.sum()));
  EXPECT_EQ(bench.probe.curve().iteration.back(), out.iterations.maxCoeff());
  EXPECT_TRUE((out.arrays.at("first_step").array() >= 0).all());
  EXPECT_GT(out.arrays.at("first_step").maxCoeff(), 0);
}

}  // namespace
}  // namespace physinv::test
