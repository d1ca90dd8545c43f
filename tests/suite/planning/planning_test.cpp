#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "suite/planning/budget.h"
#include "suite/planning/durations.h"
#include "suite/planning/split.h"
#include "suite/store/errors.h"

namespace physinv {
namespace {

std::vector<Case> cases(const std::vector<std::string>& methods,
                        const std::vector<Index>& sizes,
                        std::uint64_t seeds) {
  std::vector<Case> all;
  for (const auto& method : methods)
    for (const Index n : sizes)
      for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        Case c;
        c.info.experiment = "jpo/sample";
        c.info.method = method;
        c.info.n = n;
        c.info.seed = seed;
        all.push_back(c);
      }
  return all;
}

std::vector<std::size_t> all_of(const std::vector<Case>& cases) {
  std::vector<std::size_t> queue(cases.size());
  std::iota(queue.begin(), queue.end(), std::size_t{0});
  return queue;
}

TEST(Split, LongestFirstNeverExceedsTheBound) {
  const std::vector<double> seconds = {2, 7, 3, 3, 2, 9, 1};
  const Split split = split_longest_first(seconds, 3);
  EXPECT_EQ(split.tasks.size(), 3U);
  EXPECT_DOUBLE_EQ(split.sum, 27);
  EXPECT_LE(split.longest, 27.0 / 3 * 4 / 3);
  std::vector<std::size_t> seen;
  for (const auto& task : split.tasks)
    seen.insert(seen.end(), task.begin(), task.end());
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(seen, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(split.tasks[0].front(), 5U);  // 9 s
}

TEST(Split, NoTaskIsEmptyAndItemsWithoutCostSpread) {
  EXPECT_EQ(split_longest_first({1, 1}, 16).tasks.size(), 2U);
  for (const auto& task : split_longest_first({0, 0, 0, 0}, 2).tasks)
    EXPECT_EQ(task.size(), 2U);
}

TEST(Durations, TellOfWorkThatIsNearAndOfNothingElse) {
  const auto file = std::filesystem::temp_directory_path() /
                    fmt::format("durations-{}.csv", getpid());
  std::ofstream(file) << "experiment,method,stage,n,operations,seconds,least,"
                         "most,bytes\n"
                         "sip/heat,adam,train,8,1e9,2,1,3,1000\n";
  const Durations d = Durations::read(file);
  const auto same = d.time("sip/heat", "adam", "train", 1e9);
  ASSERT_TRUE(same);
  EXPECT_DOUBLE_EQ(same->seconds, 2);
  EXPECT_LT(same->least, 1);
  EXPECT_GT(same->most, 3);
  EXPECT_NEAR(d.time("sip/heat", "adam", "train", 2e9)->seconds, 4, 1e-12);
  EXPECT_FALSE(d.time("sip/heat", "adam", "train", 5e9));
  EXPECT_FALSE(d.time("sip/heat", "sgd", "train", 1e9));
  EXPECT_EQ(d.bytes("sip/heat", "adam", "train", 8), 1000);
  EXPECT_FALSE(d.bytes("sip/heat", "adam", "train", 9));
  for (const char* bad : {"a,b,c,1,2,3,4,5",
                          "a,b,c,1,x,3,4,5,6",
                          "a,b,c,1,-2,3,4,5,6",
                          "a,b,c,1,2,3,4,5,6,7"}) {
    std::ofstream(file) << "names\n" << bad << "\n";
    EXPECT_THROW(Durations::read(file), StoreError) << bad;
  }
  std::filesystem::remove(file);
  EXPECT_FALSE(Durations::read(file).time("sip/heat", "adam", "train", 1e9));
}

TEST(Budget, RankingIsOpenUntilRangesPart) {
  EXPECT_TRUE(undecided({{1.0, 1.1}, {2.0}}));
  EXPECT_TRUE(undecided({{1.0, 2.1}, {2.0, 3.0}}));
  EXPECT_FALSE(undecided({{2.0, 3.0}, {1.0, 1.1}}));
}

TEST(Budget, CoarsePassComesFirstAndCheapestFirst) {
  const auto all = cases({"a", "b"}, {4, 8}, 2);
  std::vector<double> seconds;
  for (const Case& c : all) seconds.push_back(static_cast<double>(c.info.n));
  const auto order = budget_order(all, all_of(all), {}, seconds);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(all[order[i]].info.seed, 0U);
    EXPECT_EQ(all[order[i]].info.n, i < 2 ? 4 : 8);
  }
}

TEST(Budget, SeedsGoWhereTheRankingIsOpen) {
  const auto all = cases({"a", "b"}, {4, 8}, 3);
  Finished finished;
  std::vector<std::size_t> queue;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const CaseInfo& c = all[i].info;
    // With n = 4, a is better for certain; with n = 8 nothing is known.
    const double gap = c.n == 4 ? 10 : 0;
    if (c.seed < 2)
      finished[i] =
          1 + static_cast<double>(c.seed) + (c.method == "b" ? gap : 0);
    else
      queue.push_back(i);
  }
  // Although they cost more.
  std::vector<double> seconds;
  for (const Case& c : all) seconds.push_back(static_cast<double>(c.info.n));
  const auto order = budget_order(all, queue, finished, seconds);
  ASSERT_EQ(order.size(), 4U);
  EXPECT_EQ(all[order[0]].info.n, 8);
  EXPECT_EQ(all[order[1]].info.n, 8);
  EXPECT_EQ(all[order[2]].info.n, 4);
}

}  // namespace
}  // namespace physinv
