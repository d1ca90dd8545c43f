#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "suite/cases/jpo/common/values.h"
#include "suite/core/check.h"
#include "suite/evidence/statistics.h"
#include "suite/results/published.h"
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

TEST(CompareLosses, SmallLossesMayCountAsEqual) {
  const Shares s = compare_losses(losses({1e-9, 1e-9, 1e-9, 2}),
                                  losses({1e-8, 1, kNaN, 1e-9}),
                                  {.relative = 1e-3, .both_below = 1e-6});
  EXPECT_EQ(s.equal, 0.25);
  EXPECT_EQ(s.better, 0.5);
  EXPECT_EQ(s.worse, 0.25);
}

TEST(CompareLosses, OtherProblemsThrow) {
  EXPECT_THROW(compare_losses(losses({1}), losses({1, 2}), Equality::strict),
               ContractError);
}

class JpoEndings : public testing::Test {
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
  /// Of seed 0 or 1, at n = 4.
  std::optional<double> of(const char* method,
                           bool refined,
                           std::uint64_t seed,
                           const RunValue& value) const {
    for (const physinv::Run& run :
         find_runs(evidence_, jpo::ending(method, refined)))
      if (run.seed() == seed) return value(run);
    return {};
  }

  Published published_;
  Evidence evidence_{results_, published_, "toy"};
};

TEST_F(JpoEndings, AreTheLastUnrefinedStages) {
  const auto stage = [&](const char* method, bool refined, std::size_t run) {
    const auto all = find_runs(evidence_, jpo::ending(method, refined));
    return run < all.size() ? all[run].stage->stage : "";
  };
  EXPECT_EQ(stage("na", false, 0), "solve");
  EXPECT_EQ(stage("jpo", false, 0), "fit");
  EXPECT_EQ(stage("jpo", true, 0), "refine");
  EXPECT_EQ(stage("jpo", true, 1), "") << "is not refined yet";
  EXPECT_EQ(stage("bfgs", true, 0), "solve") << "has no refinement";
  EXPECT_EQ(stage("gd", false, 0), "");
}

TEST_F(JpoEndings, AMissingPartnerIsNotRun) {
  EXPECT_FALSE(of("jpo", true, 1, jpo::better()));
  EXPECT_FALSE(of("supervised", false, 0, jpo::better()));
  EXPECT_FALSE(of("jpo", true, 1, jpo::decrease_before()));
}

TEST_F(JpoEndings, HaveShares) {
  // Two below, one equal, one not a number.
  EXPECT_EQ(of("jpo", true, 0, jpo::better()), 0.5);
  EXPECT_EQ(of("jpo", true, 0, jpo::equal()), 0.25);
  EXPECT_EQ(of("jpo", true, 0, jpo::worse()), 0.25);
  EXPECT_EQ(of("jpo", true, 0, jpo::f()), 0.625);
  EXPECT_EQ(of("jpo", false, 0, jpo::solved(1e-2)), 0.5);
}

TEST_F(JpoEndings, ShareOfDecrease) {
  // Problems 0 and 1: 1 / (1.001 - end); 2 and 3 never decrease.
  const double expected = 0.5 * (1 / (1.001 - 1e-9) + 1 / 1.001);
  EXPECT_NEAR(*of("jpo", true, 0, jpo::decrease_before()), expected, 1e-12);
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
}

}  // namespace
}  // namespace physinv
