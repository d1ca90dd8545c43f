#include "suite/evidence/claim.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "suite/results/published.h"
#include "tests/suite/evidence/campaigns.h"
#include "tests/suite/results/results_testing.h"

namespace physinv {
namespace {

const std::vector<std::string> kProfiles = {"smoke", "quick", "paper"};

RunValue first_loss() {
  return [](const Run& run) { return std::optional(run.stage->loss[0]); };
}

Results campaign(const char* profile, const std::vector<double>& of_seeds) {
  std::vector<CaseRecord> cases;
  for (std::size_t seed = 0; seed < of_seeds.size(); ++seed) {
    cases.push_back(case_of(
        "a", 2, seed, {"solve"}, {stage_of("solve", {of_seeds[seed], 1})}));
    cases.back().info.profile = profile;
  }
  return Results(std::move(cases));
}

const Quantity kMean = mean({"a"}, first_loss());

ClaimResult judged(std::vector<Condition> conditions,
                   const Results& results,
                   const Published& published = {}) {
  const Claim claim{.id = "P1",
                    .from = "quick",
                    .says = "something",
                    .conditions = std::move(conditions)};
  return judge({claim}, {results, published, "toy"}, kProfiles).front();
}

Verdict verdict(std::vector<Condition> conditions, const Results& results) {
  return judged(std::move(conditions), results).verdict;
}

TEST(Claim, BoundsDecideAndSayThemselves) {
  const Results results = campaign("quick", {2, 4});
  EXPECT_EQ(verdict({at_least("a", kMean, 3)}, results), Verdict::reproduced);
  EXPECT_EQ(verdict({above("a", kMean, 3)}, results), Verdict::not_reproduced);
  EXPECT_EQ(verdict({at_most("a", kMean, 3)}, results), Verdict::reproduced);
  EXPECT_EQ(verdict({below("a", kMean, 3)}, results), Verdict::not_reproduced);
  EXPECT_EQ(verdict({within("a", kMean, 3, 4)}, results), Verdict::reproduced);
  EXPECT_EQ(verdict({within("a", kMean, 1, 2.9)}, results),
            Verdict::not_reproduced);
  EXPECT_EQ(verdict({near("a", kMean, 9)}, results), Verdict::reproduced);
  EXPECT_EQ(verdict({near("a", kMean, 10)}, results), Verdict::not_reproduced);
  EXPECT_EQ(judged({within("level", kMean, 1, 2.5)}, results).evidence,
            "level 3 ± 1.41 (in 1 .. 2.5: no)");
  const Claim claim{
      .conditions = {within("level", kMean, 1, 2.5), above("a / b", kMean, 2)}};
  EXPECT_EQ(conditions_text(claim), "level in 1 .. 2.5; a / b > 2");
}

TEST(Claim, OneFailureDecidesMissingRunsDoNot) {
  const Results results = campaign("quick", {2, 4});
  const Quantity absent = mean({"b"}, first_loss());
  const auto missing =
      judged({at_least("a", kMean, 3), at_least("b", absent, 0)}, results);
  EXPECT_EQ(missing.verdict, Verdict::not_judged);
  EXPECT_EQ(missing.evidence, "a 3 ± 1.41 (>= 3); b: b not run");
  EXPECT_EQ(verdict({at_least("b", absent, 0), above("a", kMean, 9)}, results),
            Verdict::not_reproduced);
  // A bound may be what is missing.
  EXPECT_EQ(verdict({above("a", kMean, absent)}, results), Verdict::not_judged);
}

TEST(Claim, NumbersAloneAreReported) {
  const Results results = campaign("quick", {2, 4});
  EXPECT_EQ(verdict({report("a", kMean)}, results), Verdict::reported);
  EXPECT_EQ(verdict({report("b", mean({"b"}, first_loss()))}, results),
            Verdict::not_judged);
  EXPECT_EQ(
      verdict({report("b", mean({"b"}, first_loss())), at_least("a", kMean, 3)},
              results),
      Verdict::reproduced);
}

TEST(Claim, EitherMayHold) {
  const Results results = campaign("quick", {2, 4});
  const auto yes = at_least("a", kMean, 3), no = above("a", kMean, 9);
  const auto open = at_least("b", mean({"b"}, first_loss()), 0);
  EXPECT_EQ(verdict({either(no, yes)}, results), Verdict::reproduced);
  EXPECT_EQ(verdict({either(no, no)}, results), Verdict::not_reproduced);
  EXPECT_EQ(verdict({either(no, open)}, results), Verdict::not_judged);
  EXPECT_EQ(verdict({either(open, yes)}, results), Verdict::reproduced);
}

TEST(Claim, IsJudgedFromTheProfileThatDecides) {
  const auto smoke = judged({above("a", kMean, 9)}, campaign("smoke", {2, 4}));
  EXPECT_EQ(smoke.verdict, Verdict::not_judged);
  EXPECT_EQ(smoke.evidence, "needs the profile quick");
  EXPECT_EQ(verdict({above("a", kMean, 9)}, campaign("paper", {2, 4})),
            Verdict::not_reproduced);
  EXPECT_EQ(verdict({above("a", kMean, 9)}, Results()), Verdict::not_judged);
}

TEST(Claim, NothingInfiniteIsWithinBounds) {
  const Results results =
      campaign("quick", {2, std::numeric_limits<double>::infinity()});
  const Quantity worst = highest({"a"}, first_loss());
  EXPECT_EQ(verdict({at_most("a", worst, 1e300)}, results),
            Verdict::not_reproduced);
  EXPECT_EQ(judged({at_most("a", worst, 5)}, results).evidence,
            "a not finite (<= 5: no)");
}

class AsPrinted : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(dir_ / "toy.json") << R"({"publication": {"key": "toy",
      "title": "Toy", "authors": ["A"], "year": 2022, "venue": "V"},
      "values": [
      {"experiment": "toy", "quantity": "alone", "value": 50, "spread": null,
       "unit": "%", "where": "Table 4"},
      {"experiment": "toy", "quantity": "spread", "value": 50, "spread": 2,
       "unit": "%", "where": "Table 3"}]})";
    published_ = Published(dir_.path());
  }
  Verdict of(const std::vector<double>& seeds, const char* quantity) const {
    return judged({as_printed("a", kMean, quantity)},
                  campaign("quick", seeds),
                  published_)
        .verdict;
  }
  TemporaryDirectory dir_;
  Published published_;
};

TEST_F(AsPrinted, WithoutASpreadOursCountsForBoth) {
  // Deviation 2: the band is 2.83 * 2 = 5.66 around 50.
  EXPECT_EQ(of({53, 55, 57}, "alone"), Verdict::reproduced);
  EXPECT_EQ(of({54, 56, 58}, "alone"), Verdict::not_reproduced);
  EXPECT_EQ(of({50, 50, 50}, "alone"), Verdict::reproduced);
  EXPECT_EQ(of({50.1, 50.1, 50.1}, "alone"), Verdict::not_reproduced);
  EXPECT_EQ(of({50, 50}, "alone"), Verdict::not_judged);      // two seeds
  EXPECT_EQ(of({30, 50, 70}, "alone"), Verdict::not_judged);  // band 57
}

TEST_F(AsPrinted, WithOneBothCount) {
  // Ours deviates by sqrt(2), printed 2: 2 sqrt(2 + 4) = 4.9.
  EXPECT_EQ(of({53.5, 55.5}, "spread"), Verdict::reproduced);
  EXPECT_EQ(of({54, 56}, "spread"), Verdict::not_reproduced);
  EXPECT_EQ(of({53, 55, 57}, "absent"), Verdict::not_judged);
}

TEST_F(AsPrinted, NamesAreCheckedAgainstThePapersFile) {
  const auto claims = [](const char* quantity) {
    return std::vector<Claim>{
        {.id = "P1", .conditions = {as_printed("a", kMean, quantity)}}};
  };
  EXPECT_TRUE(unknown_printed(claims("alone"), "toy", published_).empty());
  EXPECT_EQ(unknown_printed(claims("alnoe"), "toy", published_).size(), 1U);
}

TEST(Claim, AboutAllowsFivePointsOrTwoErrors) {
  EXPECT_EQ(verdict({about("a", kMean, 60)}, campaign("quick", {56, 56})),
            Verdict::reproduced);
  EXPECT_EQ(verdict({about("a", kMean, 60)}, campaign("quick", {54, 54})),
            Verdict::not_reproduced);
  // Standard error of four values with deviation 10: 5.
  EXPECT_EQ(verdict({about("a", kMean, 60)},
                    campaign("quick", {42.34, 42.34, 59.66, 59.66})),
            Verdict::reproduced);
}

TEST(Claim, WhatIsWrongByItself) {
  const Claim good{.id = "P1",
                   .origin = Origin::paper,
                   .where = "Sec. 4",
                   .from = "quick",
                   .says = "s",
                   .conditions = {report("a", kMean)}};
  EXPECT_TRUE(problems_of(good, kProfiles).empty());
  const auto broken = [&](auto&& change) {
    Claim claim = good;
    change(claim);
    return problems_of(claim, kProfiles).size();
  };
  EXPECT_EQ(broken([](Claim& c) { c.id.clear(); }), 1U);
  EXPECT_EQ(broken([](Claim& c) { c.says.clear(); }), 1U);
  EXPECT_EQ(broken([](Claim& c) { c.where.clear(); }), 1U);
  EXPECT_EQ(broken([](Claim& c) { c.conditions.clear(); }), 1U);
  EXPECT_EQ(broken([](Claim& c) { c.from = "qick"; }), 1U);
}

}  // namespace
}  // namespace physinv
