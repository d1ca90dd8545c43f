#include "suite/cases/numerics/common/accuracy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "suite/results/published.h"

namespace physinv {
namespace {

const NumericalParameter kStep{.id = "step",
                               .title = "Step",
                               .axis = {"h", {1, 0.5, 0.25}, true},
                               .problems = {ProblemRecipe{}},
                               .order = 2,
                               .regime = 1};

StageRecord stage(const std::string& name, double error, double seconds) {
  StageRecord s;
  s.stage = name;
  s.arrays["error"] = Batch<double>::Constant(1, 2, error);
  s.curve.iteration = {0, 1};
  s.curve.seconds = {0, 2 * seconds};
  return s;
}

/// Errors fall with the power `order`; smaller steps take longer.
CaseRecord run_of(Precision precision, double order, double seconds) {
  CaseRecord c;
  c.info.experiment = "numerics/toy-steps";
  c.info.method = kAccuracy;
  c.info.name = "run";
  c.info.precision = precision;
  for (const char* end : {"", "-gradient"}) {
    c.stages.push_back(stage(std::string("step-1") + end, 1, seconds));
    c.stages.push_back(stage(
        std::string("step-0_5") + end, std::pow(0.5, order), 2 * seconds));
    c.stages.push_back(stage(
        std::string("step-0_25") + end, std::pow(0.25, order), 4 * seconds));
  }
  return c;
}

TEST(Accuracy, SettingsAreMeasuredAndDominated) {
  declare_parameters("numerics/toy-steps", {kStep});
  const Results results(
      {run_of(Precision::f64, 2, 1), run_of(Precision::f32, 2, 0.5)});
  const auto all = measurements({results, {}, "numerics/toy-steps"});
  ASSERT_EQ(all.size(), 12U);
  const Measurement* best = fastest_within(all, WorkOf::gradient, 0.25);
  ASSERT_NE(best, nullptr);
  EXPECT_EQ(best->setting, "h 0.5, float");
  EXPECT_DOUBLE_EQ(best->seconds, 1);
  EXPECT_DOUBLE_EQ(best->order.value(), 2);
  EXPECT_EQ(fastest_within(all, WorkOf::gradient, 1e-3), nullptr);
  for (const Measurement& m : all)
    EXPECT_EQ(dominated_by(all, m) != nullptr, m.precision == Precision::f64);
}

TEST(Accuracy, ClaimsJudgeTheOrder) {
  declare_parameters("numerics/toy-steps", {kStep});
  const auto claims = order_claims({kStep});
  ASSERT_EQ(claims.size(), 1U);
  const auto verdict = [&](double order, double diverged) {
    CaseRecord run = run_of(Precision::f64, order, 1);
    if (diverged > 0) run.stages[1].arrays["error"].setConstant(-1);
    const Results results({run});
    const Published none;
    return judge(claims, {results, none, "numerics/toy-steps"}, {"smoke"})
        .front()
        .verdict;
  };
  EXPECT_EQ(verdict(2, 0), Verdict::reproduced);
  EXPECT_EQ(verdict(2, 1), Verdict::partly_judged);
  EXPECT_EQ(verdict(1.5, 0), Verdict::not_reproduced);
}

}  // namespace
}  // namespace physinv
