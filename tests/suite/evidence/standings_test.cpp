#include "suite/evidence/standings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "suite/evidence/running_time.h"

namespace physinv {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(RunningTime, AllThatWasSpentOverWhatWasSolved) {
  const RunningTime time = expected_running_time({2, kInf, 4}, {2, 10, 4}, "a");
  EXPECT_DOUBLE_EQ(time.expected, 8);
  EXPECT_EQ(time.solved, 2U);
  EXPECT_EQ(time.problems, 3U);
  EXPECT_LT(time.low, 8);
  EXPECT_GT(time.high, 8);
  EXPECT_EQ(expected_running_time({kInf}, {10}, "a").expected, kInf);
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
  EXPECT_DOUBLE_EQ(profile_score({2.5, kInf}), 0.25);
  EXPECT_DOUBLE_EQ(profile_score({kInf}), 0);
  EXPECT_EQ(profile_score({}), 0);
}

/// Methods that go from 1 to these losses in a second each.
CommonRuns runs_of(const std::vector<std::vector<double>>& losses) {
  CommonRuns common;
  CommonRun group{.n = static_cast<Index>(losses.front().size())};
  group.examples = group.n;
  for (std::size_t m = 0; m < losses.size(); ++m) {
    common.methods.push_back(std::string(1, static_cast<char>('a' + m)));
    ConvergenceHistory history{.seconds = {0, 1}, .simulations = {1, 10}};
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
  const auto common = runs_of({{0.5, 0.4, kInf}, {0.1, 0.1, 0.1}, {0, 1, 0.1}});
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

TEST(Standings, ASentenceWithWhatWasShown) {
  std::vector<double> low, high;
  for (int k = 0; k < 100; ++k) {
    low.push_back(k < 87 ? 1e-3 : 0.9);
    high.push_back(0.1 + 1e-3 * k);
  }
  const auto common = runs_of({high, low});
  EXPECT_EQ(standing_text(common, standings(common), {{"b", "JPO"}}),
            "Of 2 methods JPO has the lowest mean rank (1.1): of 100 problems "
            "it ends below the next, a, on 87 %, above on 13 % (p < 1e-6)");
  const auto few = runs_of({{0.5}, {0.1}});
  EXPECT_NE(standing_text(few, standings(few), {}).find("shows no difference"),
            std::string::npos);
  const auto one = runs_of({{0.5}});
  EXPECT_EQ(standing_text(one, standings(one), {}), "");
}

TEST(Standings, TablesOfAnExperiment) {
  const auto common = runs_of({{0.5, 0.5, kInf}, {0, 0.1, 0.1}});
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
