#include "suite/evidence/budget_figures.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/suite/evidence/campaigns.h"

namespace physinv {
namespace {

/// Of two problems, from 1 to these losses, each gradient a simulation.
CaseRecord solved_case(const char* method,
                       Index n,
                       std::uint64_t seed,
                       const std::vector<double>& loss) {
  StageRecord s = stage_of("solve", loss, {1, 1});
  s.curve.seconds = {0, 1};
  s.curve.evaluations = {2, 20};
  return case_of(method, n, seed, {"solve"}, {std::move(s)});
}

Results some_results() {
  CaseRecord guest = solved_case("mine", 2, 0, {0.5, 0.5});
  guest.stages.front().options = {{"algorithm", "python"}};
  return Results({solved_case("bfgs", 2, 0, {0, 0.5}),
                  solved_case("bfgs", 2, 1, {0.2, 0.2}),
                  std::move(guest)});
}

const Series& series(const Panel& panel, const std::string& label) {
  return *std::ranges::find(panel.series, label, &Series::label);
}

TEST(BudgetFigures, ShareSolvedOfEachN) {
  const Results results = some_results();
  const Figure figure =
      solved_by_budget(common_runs(results, "toy"),
                       {.title = "Toy", .method_titles = {{"bfgs", "BFGS"}}});
  ASSERT_EQ(figure.panels.size(), 1U);
  EXPECT_EQ(figure.panels[0].title, "n = 2");
  ASSERT_EQ(figure.panels[0].series.size(), 2U);
  // On the second problem both find 0.5, the lowest.
  EXPECT_DOUBLE_EQ(series(figure.panels[0], "BFGS").y.back(), 1);
  EXPECT_DOUBLE_EQ(series(figure.panels[0], "mine").y.back(), 0.5);
}

TEST(BudgetFigures, OneMethodAloneIsNotCompared) {
  const Results results({solved_case("bfgs", 2, 0, {0, 0.5})});
  EXPECT_TRUE(solved_by_budget(common_runs(results, "toy"), {}).panels.empty());
  EXPECT_EQ(learning_curves(results, "toy", {}).panels.size(), 1U);
}

TEST(BudgetFigures, EveryMethodHasACurve) {
  const Results results = some_results();
  const Figure figure = learning_curves(results, "toy", {});
  ASSERT_EQ(figure.panels.size(), 1U);
  const Series& bfgs = series(figure.panels[0], "bfgs");
  EXPECT_EQ(bfgs.x, (std::vector<double>{1, 10}));
  EXPECT_DOUBLE_EQ(bfgs.y.front(), 1);
  EXPECT_DOUBLE_EQ(bfgs.y.back(), (0.25 + 0.2) / 2) << "median of two seeds";
  const Series& mine = series(figure.panels[0], "mine");
  EXPECT_EQ(mine.method, "mine");
  EXPECT_DOUBLE_EQ(mine.y.back(), 0.5) << "though it has one seed only";
}

TEST(BudgetFigures, SecondsWhereNothingIsSimulated) {
  CaseRecord fast = solved_case("a", 2, 0, {0, 0}),
             slow = solved_case("b", 2, 0, {0, 0.5});
  for (CaseRecord* c : {&fast, &slow})
    c->stages.front().curve.evaluations = {0, 0};
  const Results results({fast, slow});
  const Figure curves = learning_curves(results, "toy", {});
  EXPECT_EQ(curves.panels.at(0).x_label, "seconds");
  EXPECT_EQ(curves.panels.at(0).series.at(0).x.back(), 2) << "its whole time";
  EXPECT_GE(curves.panels.at(0).series.at(0).x.front(), 1)
      << "a logarithmic axis has no place for 0 s";
  const Figure solved = solved_by_budget(common_runs(results, "toy"), {});
  EXPECT_EQ(solved.panels.at(0).x_label, "seconds");
}

TEST(BudgetFigures, SecondsWhereOnlyTheSumOfSimulationsIsKnown) {
  CaseRecord network = solved_case("sgd", 2, 0, {0, 0.5});
  network.stages.front().curve.evaluations = {0, 0};
  network.stages.front().counts[Counter::vjp] = 80;
  const Results results({network});
  EXPECT_EQ(learning_curves(results, "toy", {}).panels.at(0).x_label,
            "seconds");
}

}  // namespace
}  // namespace physinv
