#include "suite/evidence/quantity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "suite/evidence/cell.h"
#include "suite/evidence/failures.h"
#include "suite/results/published.h"
#include "tests/suite/evidence/campaigns.h"

namespace physinv {
namespace {

RunValue first_loss() {
  return [](const Run& run) { return std::optional(run.stage->loss[0]); };
}

RunRow all_losses() {
  return [](const Run& run) {
    return std::vector<double>(run.stage->loss.begin(), run.stage->loss.end());
  };
}

/// a: seed 0 has 1 and 3 (n = 2, 4), seed 1 has 5 (n = 2); b: seed 0, n = 2.
Results campaign() {
  const auto one =
      [](const char* method, Index n, std::uint64_t seed, double v) {
        return case_of(
            method, n, seed, {"solve"}, {stage_of("solve", {v, 10 * v})});
      };
  return Results({one("a", 2, 0, 1),
                  one("a", 4, 0, 3),
                  one("a", 2, 1, 5),
                  one("b", 2, 0, 4)});
}

class QuantityTest : public testing::Test {
 protected:
  Measured of(const Quantity& q) const { return q(evidence_); }
  double value(const Quantity& q) const { return of(q).value.value(); }

  Results results_ = campaign();
  Published published_;
  Evidence evidence_{results_, published_, "toy"};
};

TEST_F(QuantityTest, StatisticsOverRuns) {
  EXPECT_EQ(value(median({"a"}, first_loss())), 3);
  EXPECT_EQ(value(lowest({"a"}, first_loss())), 1);
  EXPECT_EQ(value(highest({"a"}, first_loss())), 5);
  EXPECT_EQ(of(median({"a"}, first_loss())).runs, 3);
  EXPECT_EQ(value(median(Select{"a"}.of_sizes(3), first_loss())), 3);
  const auto above2 = [](double v) { return v > 2; };
  EXPECT_EQ(value(count({"a"}, first_loss(), above2)), 2);
  EXPECT_DOUBLE_EQ(value(share({"a"}, first_loss(), above2)), 2.0 / 3);
}

TEST_F(QuantityTest, TheFirstRunHasTheLowestSizeAndSeed) {
  const auto first = first_run(evidence_, {"a"});
  ASSERT_TRUE(first);
  EXPECT_EQ(first->n(), 2);
  EXPECT_EQ(first->seed(), 0U);
  EXPECT_EQ(first_run(evidence_, Select{"a"}.of_sizes(4))->stage->loss[0], 3);
  EXPECT_FALSE(first_run(evidence_, {"c"}));
  EXPECT_FALSE(first_run(evidence_.of("other"), {"a"}));
}

/// Two runs of a and two of b; the second of a fails.
Results one_failed(Stop stop) {
  std::vector<CaseRecord> cases;
  for (const char* method : {"a", "b"})
    for (const std::uint64_t seed : {0, 1}) {
      cases.push_back(case_of(method,
                              2,
                              seed,
                              {"fit", "refine"},
                              {stage_of("fit", {4}), stage_of("refine", {1})}));
      if (method[0] == 'a' && seed == 1)
        cases.back().stages[1] = {.stage = "refine", .stop = stop};
    }
  return Results(cases);
}

TEST_F(QuantityTest, NothingIsSaidOfTheRunsThatDidNotFail) {
  const auto any = [](double) { return true; };
  for (const Stop stop : {Stop::failed, Stop::skipped}) {
    const Results results = one_failed(stop);
    const Evidence evidence{results, published_, "toy"};
    const Select a{"a"}, b{"b"};
    for (const Quantity& q :
         {median(a, first_loss()),
          mean(a, first_loss()),
          count(a, first_loss(), any),
          share(a, first_loss(), any),
          median_of_examples(a, all_losses()),
          share_of_examples(a, all_losses(), any),
          ratio(median(b, first_loss()), median(a, first_loss())),
          median_ratio(b, a, first_loss()),
          least({median(b, first_loss()), median(a, first_loss())})}) {
      const Measured m = q(evidence);
      EXPECT_FALSE(m.value);
      EXPECT_EQ(m.missing, "a: 1 of 2 runs failed");
      EXPECT_EQ(written(m).text, "1 of 2 runs failed");
      EXPECT_EQ(cell_of(m).text, "1 of 2 runs failed");
    }
    // Requests for the stage before it, or for others, are answered.
    EXPECT_EQ(median({"a", "fit"}, first_loss())(evidence).value, 4);
    EXPECT_EQ(median(b, first_loss())(evidence).value, 1);
  }
}

TEST_F(QuantityTest, NoNumberHasNoPlaceAmongExamples) {
  const Results results(
      {case_of("a", 2, 0, {"solve"}, {stage_of("solve", {1, NAN, 3})})});
  EXPECT_EQ(
      median_of_examples({"a"}, all_losses())({results, published_, "toy"})
          .missing,
      "no finite value");
}

TEST(FailedRuns, AreATableOfTheirOwn) {
  auto cases = one_failed(Stop::failed).cases();
  cases[1].stages[1].message = "out of memory";
  const Table table = failed_runs(Results(cases), "toy");
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0].label, "a, n = 2, seed 1");
  EXPECT_EQ(table.rows[0].cells[0].text, "refine");
  EXPECT_EQ(table.rows[0].cells[1].text, "out of memory");
  EXPECT_TRUE(table.note.starts_with("1 of 4 runs failed.")) << table.note;
  EXPECT_TRUE(failed_runs(campaign(), "toy").rows.empty());
}

TEST(Each, IsOfThoseThatAreWanted) {
  const std::vector<int> all = {1, 2, 3};
  EXPECT_EQ(each(all, [](int k) { return 2 * k; }),
            (std::vector<int>{2, 4, 6}));
  EXPECT_EQ(each_if(
                all, [](int k) { return k != 2; }, [](int k) { return 2 * k; }),
            (std::vector<int>{2, 6}));
}

/// Infinite over infinite is not a ratio, in whatever order the pairs come.
TEST_F(QuantityTest, TheWorstOfPairsThatBothDivergedIsNotKnown) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const std::uint64_t diverged : {0, 1}) {
    const auto one = [&](const char* method, std::uint64_t seed, double v) {
      return case_of(method,
                     2,
                     seed,
                     {"solve"},
                     {stage_of("solve", {seed == diverged ? kInfinite : v})});
    };
    const Results results(
        {one("a", 0, 1), one("a", 1, 1), one("b", 0, 4), one("b", 1, 4)});
    const Evidence evidence{results, published_, "toy"};
    EXPECT_EQ(worst_ratio({"a"}, {"b"}, first_loss())(evidence).missing,
              "no finite value");
    EXPECT_EQ(median_ratio({"a"}, {"b"}, first_loss())(evidence).value, 0.25);
  }
}

TEST_F(QuantityTest, AMeanIsOverSeedsOfMeansOverSizes) {
  const Measured m = of(mean({"a"}, first_loss()));
  EXPECT_EQ(m.value, 3.5);  // (2 + 5) / 2
  EXPECT_DOUBLE_EQ(*m.spread, std::sqrt(4.5));
  EXPECT_EQ(m.runs, 2);
}

TEST_F(QuantityTest, Examples) {
  EXPECT_EQ(value(median_of_examples({"a"}, all_losses())), 7.5);
  const Measured share = of(
      share_of_examples({"a"}, all_losses(), [](double v) { return v < 4; }));
  EXPECT_DOUBLE_EQ(*share.value, 2.0 / 6);
  EXPECT_DOUBLE_EQ(*share.spread, std::sqrt(0.125));  // of 1/2 and 0
}

TEST_F(QuantityTest, PairsAreOfOneSizeAndSeed) {
  EXPECT_EQ(value(median_ratio({"b"}, {"a"}, first_loss())), 4);
  EXPECT_EQ(of(median_ratio({"b"}, {"a"}, first_loss())).runs, 1);
  EXPECT_EQ(median_ratio({"b"}, {"a"}, first_loss()).runs().size(), 2U);
}

TEST_F(QuantityTest, Arithmetic) {
  const Quantity a = median({"a"}, first_loss()),
                 b = median({"b"}, first_loss());
  EXPECT_EQ(value(ratio(b, a)), 4.0 / 3);
  EXPECT_EQ(value(difference(b, a)), 1);
  EXPECT_EQ(value(percent(a)), 300);
  EXPECT_EQ(value(least({a, b, 3.5})), 3);
  EXPECT_EQ(value(most({a, b, 3.5})), 4);
  EXPECT_EQ(of(times(2, mean({"a"}, first_loss()))).spread, std::sqrt(18.0));
  EXPECT_FALSE(of(ratio(0, 0)).value);  // NaN is not a value
}

TEST_F(QuantityTest, WhatIsNotThereHasAReason) {
  EXPECT_EQ(of(median({"c"}, first_loss())).missing, "c not run");
  EXPECT_EQ(of(median(Select{"a", "fit"}.of_sizes(8), first_loss())).missing,
            "a fit, n >= 8 not run");
  const RunValue none = [](const physinv::Run&) {
    return std::optional<double>();
  };
  EXPECT_EQ(of(median({"a"}, none)).missing,
            "a too short, or without this value");
  EXPECT_EQ(of(ratio(1, median({"c"}, first_loss()))).missing, "c not run");
  EXPECT_EQ(of(printed("table4/a")).missing, "printed table4/a");
  EXPECT_EQ(of(from_at_least(3, mean({"a"}, first_loss()))).missing,
            "1 of 3 runs of a");
  EXPECT_EQ(value(from_at_least(2, mean({"a"}, first_loss()))), 3.5);
}

TEST_F(QuantityTest, AnotherExperimentIsNamed) {
  const Evidence other{results_, published_, "elsewhere"};
  EXPECT_FALSE(median({"a"}, first_loss())(other).value);
  EXPECT_EQ(median(Select{"a"}.in("toy"), first_loss())(other).value, 3);
}

TEST_F(QuantityTest, UnfinishedRunsDoNotCount) {
  auto cases = campaign().cases();
  cases.erase(cases.begin());
  cases[0].info.stages = {"solve", "refine"};  // not all of the chain yet
  const Results results(cases);
  const Evidence evidence{results, published_, "toy"};
  EXPECT_EQ(lowest({"a"}, first_loss())(evidence).value, 5);
  EXPECT_EQ(lowest({"a", "solve"}, first_loss())(evidence).value, 3);
}

}  // namespace
}  // namespace physinv
