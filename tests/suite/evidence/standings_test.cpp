#include "suite/evidence/standings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "suite/evidence/running_time.h"

namespace physinv {
namespace {

constexpr double kInfiniteLoss = std::numeric_limits<double>::infinity();

TEST(RunningTime, AllThatWasSpentOverWhatWasSolved) {
  const RunningTime time =
      expected_running_time({2, kInfiniteLoss, 4}, {2, 10, 4}, "a");
  EXPECT_DOUBLE_EQ(time.expected, 8);
  EXPECT_EQ(time.solved, 2U);
  EXPECT_EQ(time.problems, 3U);
  EXPECT_LT(time.low, 8);
  EXPECT_GT(time.high, 8);
  EXPECT_EQ(expected_running_time({kInfiniteLoss}, {10}, "a").expected,
            kInfiniteLoss);
}

TEST(RunningTime, WhatNobodyKnowsMakesNoValue) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  const RunningTime time =
      expected_running_time({2, kInfiniteLoss, 4}, {2, unknown, 4}, "a");
  for (const double value : {time.expected, time.low, time.high})
    EXPECT_TRUE(std::isnan(value));
  EXPECT_EQ(time.solved, 2U);
  EXPECT_EQ(time.problems, 3U);
  EXPECT_EQ(expected_running_time({kInfiniteLoss}, {unknown}, "a").expected,
            kInfiniteLoss)
      << "never, whatever it took";
}

TEST(RunningTime, TheIntervalHoldsAndRepeatsItself) {
  std::vector<double> cost;
  for (int k = 0; k < 100; ++k) cost.push_back(k);
  const RunningTime time = expected_running_time(cost, cost, "a");
  EXPECT_DOUBLE_EQ(time.expected, 49.5);
  // The mean of 100 numbers from 0 to 99 has a deviation of 2.89.
  EXPECT_NEAR(time.low, 49.5 - 1.96 * 2.89, 1);
  EXPECT_NEAR(time.high, 49.5 + 1.96 * 2.89, 1);
  const RunningTime again = expected_running_time(cost, cost, "a");
  EXPECT_EQ(again.low, time.low);
  EXPECT_EQ(again.high, time.high);
  const RunningTime same = expected_running_time({3, 3}, {3, 3}, "a");
  EXPECT_EQ(same.low, 3);
  EXPECT_EQ(same.high, 3);
}

TEST(ProfileScore, IsTheAreaUpToAFactorOfFour) {
  EXPECT_DOUBLE_EQ(profile_score({1, 1}), 1);
  EXPECT_DOUBLE_EQ(profile_score({1, 4}), 0.5);
  EXPECT_DOUBLE_EQ(profile_score({2.5, kInfiniteLoss}), 0.25);
  EXPECT_DOUBLE_EQ(profile_score({kInfiniteLoss}), 0);
  EXPECT_EQ(profile_score({}), 0);
}

/// Methods that go from 1 to these losses in a second each.
CommonRuns runs_of(const std::vector<std::vector<double>>& losses) {
  CommonRuns common;
  CommonRun group{.n = static_cast<Index>(losses.front().size())};
  group.examples = group.n;
  for (std::size_t m = 0; m < losses.size(); ++m) {
    common.methods.push_back(std::string(1, static_cast<char>('a' + m)));
    ConvergenceHistory history{.seconds = {0, 1},
                               .simulations = {1, 10},
                               .loss = {},
                               .all_seconds = 1,
                               .all_simulations = 10};
    history.loss.push_back(Vector<double>::Ones(group.n));
    history.loss.push_back(
        Eigen::Map<const Vector<double>>(losses[m].data(), group.n));
    group.histories.push_back(std::move(history));
  }
  common.groups.push_back(std::move(group));
  common.sizes = {common.groups.front().n};
  common.seeds = 1;
  return common;
}

TEST(Standings, RanksByProblemAndPairs) {
  const auto common =
      runs_of({{0.5, 0.4, kInfiniteLoss}, {0.1, 0.1, 0.1}, {0, 1, 0.1}});
  const Standings s = standings(common);
  EXPECT_EQ(s.problems, 3U);
  EXPECT_EQ(s.order, (std::vector<std::size_t>{1, 2, 0}));
  EXPECT_DOUBLE_EQ(s.mean_rank[1], (2 + 1 + 1.5) / 3);
  EXPECT_DOUBLE_EQ(s.mean_rank[2], (1 + 3 + 1.5) / 3);
  EXPECT_DOUBLE_EQ(s.lowest[1], 2.0 / 3);
  ASSERT_EQ(s.pairs.size(), 3U);
  EXPECT_EQ(s.pairs[1].first, 1U);
  EXPECT_EQ(s.pairs[1].second, 0U);
  EXPECT_TRUE(s.pairs[1].test.down);
  EXPECT_EQ(s.pairs[1].test.below, 3U);
  EXPECT_DOUBLE_EQ(s.pairs[1].test.p, 0.25);
  EXPECT_DOUBLE_EQ(s.pairs[1].p, 0.75) << "of three pairs";
}

TEST(Standings, LossesThatReachTheSameTargetsAreEqual) {
  const auto common =
      runs_of({{1e-10, 0.11, 2}, {1e-12, 0.12, 0.99}, {1e-3, 0, 0.98}});
  const Standings s = standings(common);
  // All three solved or not: 1e-10 and 1e-12 are, 1e-3 is not.
  EXPECT_DOUBLE_EQ(s.mean_rank[0], (1.5 + 2.5 + 3) / 3);
  EXPECT_DOUBLE_EQ(s.mean_rank[1], (1.5 + 2.5 + 2) / 3);
  EXPECT_DOUBLE_EQ(s.mean_rank[2], (3.0 + 1 + 1) / 3);
  EXPECT_DOUBLE_EQ(s.lowest[0], 1.0 / 3);
  for (const MethodPair& pair : s.pairs)
    EXPECT_EQ(pair.test.ties, pair.first == 1 && pair.second == 0 ? 2U : 0U);
}

TEST(Standings, WhoFailedIsNowhereTheLowest) {
  auto common = runs_of({{0.5, kInfiniteLoss}, {0.1, kInfiniteLoss}});
  EXPECT_DOUBLE_EQ(standings(common).lowest[0], 0);
  EXPECT_DOUBLE_EQ(standings(common).lowest[1], 0.5) << "nobody has a number";
  // With a finite loss when it failed.
  common.groups[0].histories[1].failed = true;
  const Standings s = standings(common);
  EXPECT_DOUBLE_EQ(s.lowest[0], 0.5);
  EXPECT_DOUBLE_EQ(s.lowest[1], 0);
  EXPECT_EQ(s.order, (std::vector<std::size_t>{0, 1}));
}

/// Of two equal methods, one fails on a third of the seeds.
CommonRuns third_failed(std::optional<double> seconds) {
  CommonRuns all = runs_of({{0}, {0}});
  for (const bool failed : {false, true}) {
    CommonRun group = all.groups.front();
    if (failed)
      group.histories[1] = {
          .all_seconds = seconds, .all_simulations = seconds, .failed = true};
    all.groups.push_back(std::move(group));
  }
  all.seeds = 3;
  return all;
}

TEST(Standings, FailuresCostWhatTheyTook) {
  const auto tables = [](std::optional<double> seconds) {
    Section section;
    add_standings(section, third_failed(seconds), {{"b", "B"}});
    return section.tables;
  };
  const Table times = tables(4)[1];
  EXPECT_DOUBLE_EQ(*times.rows[0].cells[1].ours, 1);
  EXPECT_EQ(times.rows[1].label, "B, tau = 0.01");
  EXPECT_DOUBLE_EQ(*times.rows[1].cells[1].ours, 3) << "(1 + 1 + 4) / 2";
  EXPECT_DOUBLE_EQ(*times.rows[1].cells[4].ours, 12) << "(10 + 10 + 4) / 2";
  EXPECT_NE(times.note.find("spent until then: B 1 of 3 runs."),
            std::string::npos)
      << times.note;
  const Table unknown = tables({})[1];
  for (const std::size_t c : {1, 2, 3, 4, 5, 6})
    EXPECT_EQ(unknown.rows[1].cells[c].text, "not known");
  EXPECT_NE(unknown.note.find("B 1 of 3 runs (1 without a record of it"),
            std::string::npos)
      << unknown.note;
  const Table ranks = tables({})[0];
  EXPECT_NE(ranks.note.find("the highest: B 1 of 3 runs."), std::string::npos)
      << ranks.note;
}

TEST(Standings, ASentenceWithWhatWasShown) {
  std::vector<double> low, high;
  for (int k = 0; k < 100; ++k) {
    low.push_back(k < 87 ? 1e-3 : 0.9);
    high.push_back(0.1 + 1e-3 * k);
  }
  const auto common = runs_of({high, low});
  EXPECT_EQ(standing_text(common, standings(common), {{"b", "JPO"}}),
            "JPO ranks best of 2 methods: on 100 problems its final loss "
            "compared with a, the next, is lower on 87 % and higher on 13 % "
            "(p = 1.9e-06)");
  const auto few = runs_of({{0.5}, {0.1}});
  EXPECT_EQ(standing_text(few, standings(few), {}),
            "No method is clearly ahead of the other: b and a rank best, and "
            "on 1 problem the loss of b is lower on 100 % (p = 1, no "
            "significant difference)");
  const auto one = runs_of({{0.5}});
  EXPECT_EQ(standing_text(one, standings(one), {}), "");
}

TEST(Standings, TablesOfAnExperiment) {
  const auto common = runs_of({{0.5, 0.5, kInfiniteLoss}, {0, 0.1, 0.1}});
  Section section;
  add_standings(section, common, {{"a", "BFGS"}});
  ASSERT_EQ(section.tables.size(), 3U);
  const Table& ranks = section.tables[0];
  EXPECT_EQ(ranks.rows[0].label, "b");
  EXPECT_EQ(ranks.rows[1].label, "BFGS");
  EXPECT_EQ(ranks.rows[0].cells[2].ours, 1) << "alone in solving";
  EXPECT_EQ(ranks.rows[1].cells[2].ours, 0);
  const Table& times = section.tables[1];
  EXPECT_EQ(times.rows[0].label, "b, tau = 0.01");
  EXPECT_EQ(times.rows[0].cells[0].ours, 100);
  EXPECT_EQ(times.rows[1].cells[1].text, "never");
  for (const Table& table : section.tables)
    for (const TableRow& row : table.rows)
      EXPECT_EQ(row.cells.size(), table.columns.size()) << table.id;
  Section none;
  add_standings(none, runs_of({{0.5}}), {});
  EXPECT_TRUE(none.tables.empty());
  EXPECT_EQ(none.standing, "");
}

}  // namespace
}  // namespace physinv
