#include "suite/evidence/performance_profiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace physinv::profiles {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(PerformanceRatios, TiesAndFailures) {
  const auto r = performance_ratios({{2, 4, kInf, kInf}, {1, 4, 3, kInf}});
  EXPECT_EQ(r[0], (Costs{2, 1, kInf, kInf}));
  EXPECT_EQ(r[1], (Costs{1, 1, 1, kInf}));
}

TEST(PerformanceRatios, OneMethodIsAlwaysTheBest) {
  EXPECT_EQ(performance_ratios({{5, 7, kInf}})[0], (Costs{1, 1, kInf}));
  EXPECT_TRUE(performance_ratios({}).empty());
}

TEST(Distribution, CountsTiesOnceAndFailuresInTheDenominator) {
  const Steps s = distribution({3, 1, kInf, 1});
  EXPECT_EQ(s.x, (std::vector<double>{1, 3}));
  EXPECT_EQ(s.y, (std::vector<double>{0.5, 0.75}));
}

TEST(Distribution, AllFail) {
  EXPECT_TRUE(distribution({kInf, kInf}).x.empty());
  EXPECT_TRUE(distribution({}).x.empty());
}

// A stage whose point k comes after k + 1 seconds and 10 (k + 1) simulations.
StageRecord stage_of(const std::vector<std::vector<double>>& losses) {
  StageRecord s{.stage = "solve"};
  const auto points = static_cast<Index>(losses.size());
  const auto examples = static_cast<Index>(losses.front().size());
  s.curve.loss.resize(examples, points);
  for (Index k = 0; k < points; ++k) {
    s.curve.iteration.push_back(static_cast<double>(k));
    s.curve.seconds.push_back(static_cast<double>(k + 1));
    s.curve.evaluations.push_back(10.0 * static_cast<double>(k + 1));
    for (Index i = 0; i < examples; ++i) {
      s.curve.loss(i, k) =
          losses[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)];
    }
  }
  s.loss = s.curve.loss.col(points - 1);
  s.clocks.solve.wall = static_cast<double>(points);
  s.counts[Counter::vjp] = 10 * static_cast<std::uint64_t>(points);
  return s;
}

CaseRecord case_of(const std::string& method,
                   std::vector<StageRecord> stages,
                   Index n = 2,
                   std::uint64_t seed = 0) {
  CaseRecord c;
  c.info.experiment = "e";
  c.info.method = method;
  c.info.n = n;
  c.info.seed = seed;
  c.info.stages.resize(stages.size());
  c.stages = std::move(stages);
  return c;
}

TEST(TargetCosts, WholeChainsAgainstTheBestLossFound) {
  // Starts at 1 (the lower one), best 0 and 0.5: targets 0.1 and 0.55.
  const Results results({
      case_of(
          "a",
          {stage_of({{1, 2}, {0.5, 0.5}}), stage_of({{0.5, 0.5}, {0, 0.5}})}),
      case_of("b", {stage_of({{2, 1}, {0.05, kInf}, {0.05, 0.9}})}),
  });
  const TargetCosts costs = target_costs(results, "e", 0.1);
  EXPECT_EQ(costs.methods, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(costs.problems, 2);
  EXPECT_EQ(costs.solved_at_start, 0);
  // The second stage begins after 2 seconds and 20 simulations.
  EXPECT_EQ(costs.seconds[0], (Costs{4, 2}));
  EXPECT_EQ(costs.seconds[1], (Costs{2, kInf}));
  EXPECT_EQ(costs.simulations[0], (Costs{20, 10}));  // 40 and 20 of n = 2
  EXPECT_EQ(costs.simulations[1], (Costs{10, kInf}));
}

TEST(TargetCosts, WhatStartsAtItsTargetIsLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Results results({case_of("a", {stage_of({{1, nan}, {1, nan}})}),
                         case_of("b", {stage_of({{3, nan}, {2, nan}})})});
  const TargetCosts costs = target_costs(results, "e", 0.01);
  EXPECT_EQ(costs.problems, 0);
  EXPECT_EQ(costs.solved_at_start, 2);
}

TEST(TargetCosts, OnlyWhereAllMethodsHaveFinished) {
  auto unfinished = case_of("b", {stage_of({{1, 1}, {0, 0}})}, 2, 1);
  unfinished.info.stages.resize(2);
  auto failed = case_of("b", {stage_of({{1, 1}, {0, 0}})});
  failed.stages[0].stop = Stop::failed;
  const auto good = [](std::uint64_t seed) {
    return case_of("a", {stage_of({{1, 1}, {0, 0}})}, 2, seed);
  };
  const Results results({good(0), good(1), good(2), failed, unfinished});
  const TargetCosts costs = target_costs(results, "e", 0.1);
  EXPECT_EQ(costs.problems, 2);  // of seed 0
  EXPECT_EQ(costs.seeds, 1);
  EXPECT_EQ(costs.seconds[1], (Costs{kInf, kInf}));
}

TEST(ProfileFigures, StairsFromTheBestToTheLast) {
  const Results results({case_of("a", {stage_of({{1, 1}, {0, 0}})}),
                         case_of("b", {stage_of({{1, 1}, {1, 0}})})});
  const auto figures = performance_profile_figures(
      results,
      "e",
      {.title = "E", .method_titles = {{"a", "A"}}, .tolerances = {0.1}});
  ASSERT_EQ(figures.size(), 3U);
  EXPECT_EQ(figures[0].id, "performance_profile");
  EXPECT_EQ(figures[1].id, "time_to_target");
  ASSERT_EQ(figures[0].panels.size(), 2U);
  const Panel& profile = figures[0].panels[0];
  ASSERT_EQ(profile.series.size(), 2U);
  EXPECT_EQ(profile.series[0].label, "A");
  EXPECT_EQ(profile.series[1].label, "b");
  EXPECT_EQ(profile.series[0].y, (std::vector<double>{1, 1}));
  EXPECT_EQ(profile.series[1].y, (std::vector<double>{0.5, 0.5}));
  const Panel& reached = figures[1].panels[0];
  EXPECT_EQ(reached.series[0].x.front(), 2);
  EXPECT_NE(figures[0].note.find("2 problems of n = 2 and 1 seed;"),
            std::string::npos);
}

TEST(ProfileFigures, AllTargetsAreOneDistribution) {
  // Method a is at 0.1 after a second more and never lower, b ends at 0.
  const Results results({case_of("a", {stage_of({{1}, {0.1}})}, 1),
                         case_of("b", {stage_of({{1}, {1}, {0}})}, 1)});
  const auto targets = distribution_targets();
  ASSERT_EQ(targets.size(), 24U);
  EXPECT_DOUBLE_EQ(targets[3], 0.1);
  EXPECT_DOUBLE_EQ(targets[23], 1e-6);
  const Figure figure = performance_profile_figures(
      results, "e", {.title = "E", .tolerances = {0.1}})[2];
  EXPECT_EQ(figure.id, "runtime_distribution");
  ASSERT_EQ(figure.panels.size(), 2U);
  const Panel& seconds = figure.panels[0];
  EXPECT_DOUBLE_EQ(seconds.series[0].y.back(), 4.0 / 24) << "0.1 and easier";
  EXPECT_DOUBLE_EQ(seconds.series[1].y.back(), 1);
  EXPECT_EQ(seconds.series[1].x.front(), 2);
  EXPECT_DOUBLE_EQ(seconds.series[1].y.front(), 0);
  EXPECT_NE(figure.note.find("24 pairs"), std::string::npos) << figure.note;
}

TEST(ProfileFigures, WithoutSimulationsThereIsNoAxisOfThem) {
  CaseRecord a = case_of("a", {stage_of({{1}, {0}})}, 1),
             b = case_of("b", {stage_of({{1}, {1}, {0}})}, 1);
  for (CaseRecord* c : {&a, &b})
    std::ranges::fill(c->stages.front().curve.evaluations, 0);
  for (const Figure& figure : performance_profile_figures(
           Results({a, b}), "e", {.title = "E", .tolerances = {0.1}}))
    EXPECT_EQ(figure.panels.size(), 1U) << figure.id;
}

TEST(TargetCosts, WhatIsNotSolvedSpentAllThereWas) {
  const Results results({case_of("a", {stage_of({{1, 1}, {0, 1}})}),
                         case_of("b", {stage_of({{1, 1}, {0, 1}, {0, 0}})})});
  const TargetCosts costs = target_costs(results, "e", 0.1);
  EXPECT_EQ(costs.seconds[0], (Costs{2, kInf}));
  EXPECT_EQ(costs.spent_seconds[0], (Costs{2, 2}));
  EXPECT_EQ(costs.spent_simulations[1], (Costs{10, 15}));
}

/// A stage that failed after so many seconds and simulations.
StageRecord failed_after(double seconds, std::uint64_t simulations) {
  StageRecord s{.stage = "solve", .stop = Stop::failed};
  s.clocks.setup.wall = 0.5;
  s.clocks.solve.wall = seconds;
  s.counts[Counter::forward] = simulations;
  return s;
}

TEST(TargetCosts, AFailedRunCostsWhatItTookUntilItFailed) {
  const auto costs = [](std::vector<StageRecord> failing) {
    return target_costs(
        Results({case_of("a", {stage_of({{1, 1}, {0, 0}})}),
                 case_of("b", std::move(failing)),
                 case_of("a", {stage_of({{1, 1}, {0, 0}})}, 2, 1),
                 case_of("b", {stage_of({{1, 1}, {0, 0}})}, 2, 1)}),
        "e",
        0.1);
  };
  const TargetCosts at_once = costs({failed_after(7, 40)});
  EXPECT_EQ(at_once.problems, 4);
  EXPECT_EQ(at_once.seconds[1], (Costs{kInf, kInf, 2, 2}));
  EXPECT_EQ(at_once.spent_seconds[1], (Costs{7, 7, 2, 2}));
  EXPECT_EQ(at_once.spent_simulations[1], (Costs{20, 20, 10, 10}));
  // What was reached before the failure was reached.
  const TargetCosts later =
      costs({stage_of({{1, 1}, {0, 0.5}}), failed_after(7, 40)});
  EXPECT_EQ(later.seconds[1], (Costs{2, kInf, 2, 2}));
  EXPECT_EQ(later.spent_seconds[1], (Costs{2, 9, 2, 2}));
  EXPECT_EQ(later.spent_simulations[1], (Costs{10, 30, 10, 10}));
  // Its process was lost, or it is of before this was recorded.
  StageRecord lost{.stage = "solve", .stop = Stop::failed};
  EXPECT_TRUE(std::isnan(costs({lost}).spent_seconds[1][0]));
  StageRecord calls = failed_after(7, 0);
  calls.counts.forget(Counter::forward);
  EXPECT_EQ(costs({calls}).spent_seconds[1][0], 7);
  EXPECT_TRUE(std::isnan(costs({calls}).spent_simulations[1][0]));
  // What comes behind the failure was not run.
  StageRecord behind{.stage = "refine", .stop = Stop::skipped};
  EXPECT_EQ(costs({failed_after(7, 40), behind}).spent_seconds[1][0], 7);
}

TEST(TargetCosts, WhereAllMethodsFailTheProblemsAreCounted) {
  const auto both = [](std::uint64_t seed, bool fail) {
    std::vector<CaseRecord> cases;
    for (const char* method : {"a", "b"})
      cases.push_back(
          case_of(method,
                  {fail ? failed_after(1, 1) : stage_of({{1, 1}, {0, 0}})},
                  2,
                  seed));
    return cases;
  };
  auto cases = both(0, false);
  for (auto& c : both(1, true)) cases.push_back(std::move(c));
  const TargetCosts costs = target_costs(Results(cases), "e", 0.1);
  EXPECT_EQ(costs.problems, 2);
  EXPECT_EQ(costs.solved_at_start, 2) << "left out, and said";
  EXPECT_EQ(costs.seeds, 2);
}

/// A network's run: some examples along the curve, and the mean of all.
StageRecord training_of(const std::vector<double>& means) {
  std::vector<std::vector<double>> tracked(means.size(), {7, 7});
  StageRecord s = stage_of(tracked);
  s.loss = Vector<double>::Constant(5, 7);
  Batch<double> mean(1, static_cast<Index>(means.size()));
  for (std::size_t k = 0; k < means.size(); ++k)
    mean(0, static_cast<Index>(k)) = means[k];
  s.arrays["mean_loss"] = mean;
  return s;
}

TEST(TargetCosts, OfRunsThatAreJudgedByAMean) {
  const Results results({case_of("a", {training_of({4, 1, 0})}, 5),
                         case_of("b", {training_of({4, 0.3, 0.3})}, 5)});
  const TargetCosts costs = target_costs(results, "e", 0.1);
  EXPECT_TRUE(costs.runs);
  EXPECT_EQ(costs.problems, 1);
  EXPECT_EQ(costs.seconds[0], (Costs{3}));
  EXPECT_EQ(costs.seconds[1], (Costs{2}));
  EXPECT_EQ(costs.simulations[1], (Costs{20}));
}

TEST(TargetCosts, OfManyMethodsThoseThatEndLowest) {
  const Results results({case_of("a", {training_of({4, 3})}, 5),
                         case_of("b", {training_of({4, kInf})}, 5),
                         case_of("c", {training_of({4, 1})}, 5)});
  const TargetCosts costs = target_costs(results, "e", 0.1, 2);
  EXPECT_EQ(costs.methods, (std::vector<std::string>{"a", "c"}));
  EXPECT_EQ(costs.left_out, 1);
}

TEST(TargetCosts, AMethodThatFailsMostlyDoesNotEndLowest) {
  const auto run = [](const char* method, std::uint64_t seed, double end) {
    return case_of(method, {training_of({4, end})}, 5, seed);
  };
  const auto lost = [](std::uint64_t seed) {
    return case_of("b", {failed_after(1, 1)}, 5, seed);
  };
  const Results results({run("a", 0, 3),
                         run("a", 1, 3),
                         run("a", 2, 3),
                         run("b", 0, 1),
                         lost(1),
                         lost(2),
                         run("c", 0, 2),
                         run("c", 1, 2),
                         run("c", 2, 2)});
  const TargetCosts costs = target_costs(results, "e", 0.1, 2);
  EXPECT_EQ(costs.methods, (std::vector<std::string>{"a", "c"}));
  // The last seed's group says no less that a problem is a run.
  const Results pair({run("a", 0, 3), lost(0), run("a", 1, 3), lost(1)});
  EXPECT_TRUE(target_costs(pair, "e", 0.1).runs);
}

TEST(TargetCosts, ATrainingThatDivergedEndsWithoutALoss) {
  auto diverged = training_of({4, 0.5});
  diverged.stop = Stop::diverged;
  auto overflow = training_of({4, std::numeric_limits<double>::max()});
  const Results results(
      {case_of("a", {diverged}, 5), case_of("b", {overflow}, 5)});
  const CommonRuns common = common_runs(results, "e");
  EXPECT_EQ(final_loss(common.groups[0].histories[0], 0), kInf);
  EXPECT_EQ(final_loss(common.groups[0].histories[1], 0), kInf);
  // What it reached before counts as reached.
  EXPECT_EQ(target_costs(common, 0.1).seconds[0], (Costs{2}));
}

TEST(ProfileFigures, SayWhyThereIsNothingToCompare) {
  const Results one({case_of("a", {stage_of({{1, 1}, {0, 0}})})});
  const Results apart({case_of("a", {stage_of({{1, 1}, {0, 0}})}),
                       case_of("b", {stage_of({{1}, {0}})})});
  for (const auto& [results, why] :
       {std::pair{&one, "only one method"}, {&apart, "the same problems"}}) {
    const auto figures = performance_profile_figures(*results, "e", {});
    ASSERT_EQ(figures.size(), 2U);
    for (const Figure& figure : figures) {
      EXPECT_NE(figure.note.find(why), std::string::npos) << figure.note;
      ASSERT_EQ(figure.panels.size(), 1U);
      EXPECT_TRUE(figure.panels[0].series.empty());
    }
  }
}

}  // namespace
}  // namespace physinv::profiles
