#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "suite/cases/jpo/common/shares.h"
#include "suite/core/check.h"
#include "tests/suite/evidence/campaigns.h"
#include "tests/support/reference.h"

namespace physinv {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(MeanStd, OrdinarySampleDeviation) {
  EXPECT_FALSE(mean_std({}));
  EXPECT_FALSE(mean_std(std::vector{3.0})->std);
  const auto found = mean_std(std::vector{1.0, 2.0, 6.0});
  EXPECT_DOUBLE_EQ(found->mean, 3.0);
  EXPECT_DOUBLE_EQ(*found->std, std::sqrt((4.0 + 1.0 + 9.0) / 2));
}

TEST(CompareLosses, StrictIsBitwise) {
  const auto ours = losses({1, 2, 3, 0.5 * (1 + 1e-9)});
  const auto bfgs = losses({2, 2, 1, 0.5});
  const Shares strict = compare_losses(ours, bfgs, Equality::strict);
  EXPECT_EQ(strict.better, 0.25);
  EXPECT_EQ(strict.equal, 0.25);
  EXPECT_EQ(strict.worse, 0.5);
  EXPECT_EQ(strict.f(), 0.375);
  const Shares tol = compare_losses(ours, bfgs, Equality::tol);
  EXPECT_EQ(tol.better, 0.25);
  EXPECT_EQ(tol.equal, 0.5);
  EXPECT_EQ(tol.f(), 0.5);
}

// The scores of the Navier-Stokes experiment, every entry of their oracle.
TEST(CompareLosses, AgreesWithTheOracle) {
  test::check_entries_named(
      "jpo-navier-stokes", "scores", [](const test::Json& entry) {
        const test::Json in = entry.at("inputs"), out = entry.at("outputs");
        const Vector<double> method = test::vector(in.at("method")),
                             bfgs = test::vector(in.at("bfgs"));
        const Shares strict = compare_losses(method, bfgs, Equality::strict),
                     band = compare_losses(method, bfgs, Equality::band);
        const auto share = decrease_share(test::vector(in.at("start")),
                                          method,
                                          test::vector(in.at("refined")));
        ASSERT_TRUE(share);
        const std::map<std::string, double> found = {
            {"better", strict.better},
            {"equal", strict.equal},
            {"f", strict.f()},
            {"better_tol", band.better},
            {"equal_tol", band.equal},
            {"network_fraction", *share}};
        const test::Json t = entry.at("tolerance");
        const test::Comparator near(t.at("rel"), t.at("abs"));
        for (const auto& [key, value] : found)
          EXPECT_TRUE(near(value, test::number(out.at(key)))) << key;
      });
}

TEST(CompareLosses, NonFiniteIsWorse) {
  for (const Equality equality : {Equality::strict, Equality::tol}) {
    const Shares s = compare_losses(losses({kNaN, kInf, kNaN, 1, 1}),
                                    losses({1, kInf, kNaN, kNaN, kInf}),
                                    equality);
    EXPECT_DOUBLE_EQ(s.worse, 0.6);
    EXPECT_DOUBLE_EQ(s.better + s.equal, 0.4);
  }
}

TEST(CompareLosses, NonFinitePartnerIsBeaten) {
  const Shares s =
      compare_losses(losses({1, 1}), losses({kNaN, kInf}), Equality::strict);
  EXPECT_EQ(s.better, 1);
  const Shares t =
      compare_losses(losses({1, 1}), losses({kNaN, kInf}), Equality::tol);
  EXPECT_EQ(t.better, 1);
}

TEST(CompareLosses, OtherProblemsThrow) {
  EXPECT_THROW(compare_losses(losses({1}), losses({1, 2}), Equality::strict),
               ContractError);
}

class JpoMetricsTest : public testing::Test {
 protected:
  // Seed 1 of jpo has not been refined yet; seed 0 is complete.
  Results results_{{
      case_of(
          "bfgs", 4, 0, {"solve"}, {stage_of("solve", {0.5, 1e-9, 0.5, 0})}),
      case_of("bfgs", 4, 1, {"solve"}, {stage_of("solve", {0.5, 0.5, 0, 0})}),
      case_of("jpo",
              4,
              0,
              {"fit", "refine"},
              {stage_of("fit", {1e-3, 1e-3, 0.5, 2}, {1.001, 1.001, 0.5, 2}),
               stage_of("refine", {1e-9, 0, 0.5, kNaN})}),
      case_of("jpo", 4, 1, {"fit", "refine"}, {stage_of("fit", {1, 1, 1, 1})}),
      case_of("na",
              4,
              0,
              {"fit", "solve", "refine"},
              {stage_of("fit", {9, 9, 9, 9}),
               stage_of("solve", {0.5, 9, 0, 9}),
               stage_of("refine", {0.5, 9, 0, 9})}),
  }};
  JpoMetrics metrics_{results_, "toy"};
  const std::vector<Index> all_{4};
};

TEST_F(JpoMetricsTest, EndingIsTheLastUnrefinedStage) {
  EXPECT_EQ(metrics_.ending("na", 4, 0, false)->stage, "solve");
  EXPECT_EQ(metrics_.ending("jpo", 4, 0, false)->stage, "fit");
  EXPECT_EQ(metrics_.ending("jpo", 4, 0, true)->stage, "refine");
  EXPECT_EQ(metrics_.ending("jpo", 4, 1, true), nullptr);
  EXPECT_EQ(metrics_.ending("gd", 4, 0, false), nullptr);
}

TEST_F(JpoMetricsTest, AMissingPartnerIsNotRun) {
  EXPECT_FALSE(metrics_.shares("jpo", 4, 1, true, Equality::strict));
  EXPECT_FALSE(metrics_.shares("supervised", 4, 0, false, Equality::strict));
  EXPECT_FALSE(metrics_.mean_shares("gd", all_, false, Equality::strict));
  EXPECT_FALSE(metrics_.solved_share("jpo", 8, 0, false, 1e-6));
  EXPECT_FALSE(metrics_.share_of_decrease("jpo", 4, 1));
}

TEST_F(JpoMetricsTest, SharesAndTheirMean) {
  const auto s = metrics_.shares("jpo", 4, 0, true, Equality::strict);
  ASSERT_TRUE(s);
  EXPECT_EQ(s->better, 0.5);  // two below, one equal, one not a number
  EXPECT_EQ(s->equal, 0.25);
  EXPECT_EQ(s->worse, 0.25);
  // Unrefined: 1 of 4 better and 1 equal, then 0 better and 0 equal.
  const auto mean = metrics_.mean_shares("jpo", all_, false, Equality::strict);
  ASSERT_TRUE(mean);
  EXPECT_EQ(mean->pairs, 2);
  EXPECT_EQ(mean->mean.better, 0.125);
  EXPECT_EQ(mean->mean.equal, 0.125);
  EXPECT_DOUBLE_EQ(*mean->better_std, 0.25 / std::sqrt(2.0));
}

TEST_F(JpoMetricsTest, ShareOfDecrease) {
  // Problems 0 and 1: 1 / (1.001 - end); 2 and 3 never decrease.
  const double expected = 0.5 * (1 / (1.001 - 1e-9) + 1 / 1.001);
  EXPECT_NEAR(*metrics_.share_of_decrease("jpo", 4, 0), expected, 1e-12);
}

TEST_F(JpoMetricsTest, SolvedShares) {
  EXPECT_EQ(*metrics_.solved_share("jpo", 4, 0, false, 1e-2), 0.5);
}

TEST(SolvedTest, MayAskForTheTruthInsteadOfTheLoss) {
  CaseRecord c =
      case_of("bfgs", 3, 0, {"solve"}, {stage_of("solve", {1, 1, 1})});
  StageRecord& s = c.stages.front();
  s.x = c.data.x;
  s.x(1, 1) += 0.9e-3;
  s.x(0, 2) -= 1.1e-3;
  const Solved near = within_of_truth(1e-3);
  EXPECT_TRUE(near(c.data, s, 0));
  EXPECT_TRUE(near(c.data, s, 1));
  EXPECT_FALSE(near(c.data, s, 2));
  s.x(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(near(c.data, s, 0));
  EXPECT_EQ(near.count(c.data, s), 1);
  EXPECT_EQ(Solved(1e-6).count(c.data, s), 0);
  EXPECT_EQ(Solved(2).count(c.data, s), 3);
  EXPECT_EQ(Solved(1e-6).says(), "loss < 1e-06");

  const Results results({c});
  const JpoMetrics metrics(results, "toy");
  EXPECT_DOUBLE_EQ(*metrics.solved_share("bfgs", 3, 0, false, near), 1.0 / 3);
}

}  // namespace
}  // namespace physinv
