#include "suite/evidence/claim.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "suite/results/published.h"
#include "suite/results/verdict_words.h"
#include "tests/suite/evidence/campaigns.h"
#include "tests/suite/store/store_testing.h"

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

TEST(Claim, IsJudgedFromTheProfileThatItNamesOrItsOwnersFirst) {
  EXPECT_EQ((Claim{.id = "A1", .from = "smoke"}.judged_from()), "smoke");
  EXPECT_EQ((Claim{.id = "A1"}.judged_from()), "quick");
  EXPECT_EQ((Claim{.id = "P1", .where = "Sec. 1"}.judged_from()), "paper");
}

TEST(Claim, BoundsDecideAndSayThemselves) {
  const Results results = campaign("quick", {2, 4});
  EXPECT_EQ(verdict({at_least("a", kMean, 3)}, results), Verdict::reproduced);
  EXPECT_EQ(verdict({above("a", kMean, 3)}, results), Verdict::not_reproduced);
  EXPECT_EQ(verdict({at_most("a", kMean, 3)}, results), Verdict::reproduced);
  EXPECT_EQ(verdict({below("a", kMean, 3)}, results), Verdict::not_reproduced);
  EXPECT_EQ(verdict({within("a", kMean, 3, 4)}, results), Verdict::reproduced);
  EXPECT_EQ(verdict({equals("a", kMean, 3)}, results), Verdict::reproduced);
  EXPECT_EQ(verdict({equals("a", kMean, 2.5, 0.6)}, results),
            Verdict::reproduced);
  EXPECT_EQ(verdict({equals("a", kMean, 2.5, 0.4)}, results),
            Verdict::not_reproduced);
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
  EXPECT_EQ(missing.verdict, Verdict::partly_judged);
  EXPECT_EQ(missing.evidence, "a 3 ± 1.41 (>= 3); b: b not run");
  EXPECT_EQ(verdict({at_least("b", absent, 0)}, results), Verdict::not_judged);
  EXPECT_EQ(verdict({at_least("b", absent, 0), above("a", kMean, 9)}, results),
            Verdict::not_reproduced);
  // A bound may be what is missing.
  EXPECT_EQ(verdict({above("a", kMean, absent)}, results), Verdict::not_judged);
}

TEST(Claim, NumbersAloneAreReported) {
  const Results results = campaign("quick", {2, 4});
  EXPECT_EQ(verdict({reported("a", kMean)}, results), Verdict::reported);
  EXPECT_EQ(verdict({reported("b", mean({"b"}, first_loss()))}, results),
            Verdict::not_judged);
  EXPECT_EQ(verdict({reported("b", mean({"b"}, first_loss())),
                     at_least("a", kMean, 3)},
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
       "unit": "%", "where": "Table 3"},
      {"experiment": "toy", "quantity": "twice", "value": 100, "spread": 4,
       "unit": "%", "where": "Table 3"}]})";
    published_ = Published(dir_.path());
  }
  ClaimResult result(Condition condition,
                     const std::vector<double>& seeds) const {
    return judged({std::move(condition)}, campaign("quick", seeds), published_);
  }
  /// The paper has four seeds.
  Verdict of(const std::vector<double>& seeds, const char* quantity) const {
    return result(as_printed("a", kMean, quantity, 4), seeds).verdict;
  }
  Verdict jointly(const std::vector<double>& seeds) const {
    return judged(joint_, campaign("quick", seeds), published_).verdict;
  }
  const std::vector<Condition> joint_ = jointly_as_printed(
      "p", {{"m", kMean, "spread"}, {"twice", times(2, kMean), "twice"}}, 4);
  TemporaryDirectory dir_;
  Published published_;
};

TEST_F(AsPrinted, TheBandIsThatOfTwoMeans) {
  // Runs of two problems: the binomial floor at 50 % is 35 points, wider than
  // any deviation here; 2 * 35.4 sqrt(1/4 + 1/4) = 50.
  EXPECT_EQ(of({89, 89, 91, 91}, "alone"), Verdict::reproduced);
  EXPECT_EQ(result(as_printed("a", kMean, "alone", 4), {50, 50, 50, 50})
                .conditions[0]
                .bounds,
            "printed 50 +- 50");
  // Of 1000 the floor is 1.6; deviation 4: 2 * 4 sqrt(1/4 + 1/4) = 5.66.
  const auto many = [&](double shift) {
    std::vector<CaseRecord> cases;
    const double level[] = {46.54, 46.54, 53.46, 53.46};
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      cases.push_back(case_of("a",
                              1000,
                              seed,
                              {"solve"},
                              {stage_of("solve", {level[seed] + shift, 1})}));
      cases.back().info.profile = "quick";
    }
    return judged({as_printed("a", kMean, "alone", 4)},
                  Results(std::move(cases)),
                  published_)
        .verdict;
  };
  EXPECT_EQ(many(5.6), Verdict::reproduced);
  EXPECT_EQ(many(-5.6), Verdict::reproduced);
  EXPECT_EQ(many(5.7), Verdict::not_reproduced);
  EXPECT_EQ(of({50, 50}, "alone"), Verdict::not_judged);  // two seeds
  EXPECT_EQ(of({53, 55, 57}, "absent"), Verdict::not_judged);
}

TEST_F(AsPrinted, WhatNoFileHasIsStated) {
  EXPECT_EQ(result(as_stated("a", kMean, 50, 4), {89, 89, 91, 91}).verdict,
            Verdict::reproduced);
  EXPECT_EQ(result(as_stated("a", kMean, 1, 4), {90, 90, 91, 91}).verdict,
            Verdict::not_reproduced);
}

TEST_F(AsPrinted, MeansWithDeviationsAreJudgedTogether) {
  // Printed 50 +- 2 and 100 +- 4 of four seeds each, ours as wide: a shift of
  // d is (d / sqrt 2)^2 twice, and chi squared of two is 5.99 at 5 %.
  EXPECT_EQ(jointly({48, 50, 52, 54}), Verdict::reproduced);
  EXPECT_EQ(jointly({49.3, 51.3, 53.3, 55.3}), Verdict::reproduced);
  EXPECT_EQ(jointly({50.5, 52.5, 54.5, 56.5}), Verdict::not_reproduced);
  EXPECT_EQ(jointly({50, 50}), Verdict::not_judged);
}

TEST_F(AsPrinted, NamesAreCheckedAgainstThePapersFile) {
  const auto claims = [](const char* quantity) {
    return std::vector<Claim>{
        {.id = "P1", .conditions = {as_printed("a", kMean, quantity, 4)}}};
  };
  EXPECT_TRUE(unknown_printed(claims("alone"), "toy", published_).empty());
  EXPECT_EQ(unknown_printed(claims("alnoe"), "toy", published_).size(), 1U);
  EXPECT_TRUE(unknown_printed(claims("toy alone"), "a", published_).empty());
  EXPECT_EQ(unknown_printed(claims("toy alnoe"), "a", published_).size(), 1U);
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

class Caused : public testing::Test {
 protected:
  static ClaimResult of(const Cause& cause, const Condition& condition) {
    const Claim claim{.id = "P1",
                      .from = "quick",
                      .says = "something",
                      .conditions = {condition},
                      .cause = cause};
    const Published none;
    return judge({claim}, {campaign("quick", {2, 4}), none, "toy"}, kProfiles)
        .front();
  }
  const Condition holds_ = at_least("a", kMean, 3);
  const Condition fails_ = above("a", kMean, 9);
  const Condition open_ = at_least("b", mean({"b"}, first_loss()), 0);
};

TEST_F(Caused, AFailureCountsAsItsCauseSays) {
  for (const Cause& cause : {depends("why"),
                             stronger("why", {holds_}),
                             weaker("why", {holds_}),
                             contradiction("why"),
                             fails("why")}) {
    const auto found = of(cause, fails_);
    EXPECT_EQ(found.verdict, cause.as);
    EXPECT_EQ(found.cause, "why");
  }
  EXPECT_EQ(of({}, fails_).verdict, Verdict::not_reproduced);
  EXPECT_EQ(of({}, fails_).cause, "");
}

TEST_F(Caused, AVerdictIsComputedAllTheSame) {
  const auto stale = of(depends("why"), holds_);
  EXPECT_EQ(stale.verdict, Verdict::reproduced);
  EXPECT_EQ(cause_text(stale.verdict, stale.cause),
            "Reproduced; its cause is stale: why");
  EXPECT_EQ(of(not_run("an hour"), holds_).cause, "");
}

TEST_F(Caused, WhatDoesNotShowExplainsNothing) {
  const auto found = of(weaker("why", {fails_}), fails_);
  EXPECT_EQ(found.verdict, Verdict::not_reproduced);
  EXPECT_EQ(found.cause,
            "why (which does not show here: a 3 ± 1.41 (> 9: no))");
  // What was not run does not count against it.
  EXPECT_EQ(of(weaker("why", {open_}), fails_).verdict, Verdict::weaker);
}

TEST_F(Caused, WhatIsNotJudgedSaysWhatItTakes) {
  const auto waits = of(not_run("an hour"), open_);
  EXPECT_EQ(waits.verdict, Verdict::not_judged);
  EXPECT_EQ(waits.cause, "an hour");
  // An hour explains no failure.
  EXPECT_EQ(of(not_run("an hour"), fails_).verdict, Verdict::not_reproduced);
  EXPECT_EQ(of(not_run("an hour"), fails_).cause, "");
}

TEST_F(AsPrinted, KeptNumbersAreJudgedAgain) {
  const Results plan = campaign("quick", {0, 0, 0, 0});
  const auto again = [&](const std::vector<Condition>& now,
                         const ClaimResult& kept) {
    const Evidence planned{plan, published_, "toy"};
    return judge_again({.id = "P1", .from = "quick", .conditions = now},
                       kept,
                       {planned, planned});
  };
  const auto kept = result(as_printed("a", kMean, "alone", 4), {9, 9, 10, 10});
  EXPECT_EQ(kept.verdict, Verdict::reproduced);
  // Another printed number, another relation, another label.
  EXPECT_EQ(again({as_printed("a", kMean, "twice", 4)}, kept).verdict,
            Verdict::not_reproduced);
  EXPECT_EQ(again({above("a", kMean, 1)}, kept).verdict, Verdict::not_judged);
  EXPECT_EQ(again({as_printed("b", kMean, "alone", 4)}, kept).evidence,
            "b: not kept; needs a run");
  const auto bound = result(above("a", kMean, 9), {9, 9, 10, 10});
  EXPECT_EQ(again({above("a", kMean, 9.6)}, bound).verdict,
            Verdict::not_reproduced);
  EXPECT_EQ(
      again({either(at_least("c", kMean, 9.6), above("a", kMean, 9))}, bound)
          .verdict,
      Verdict::reproduced);
}

TEST_F(AsPrinted, ABoundThatWasMeasuredStaysAsItWas) {
  const Results plan = campaign("quick", {0, 0});
  const Evidence planned{plan, published_, "toy"};
  const Condition half = above("a", kMean, times(0.5, kMean)),
                  twice = above("a", kMean, times(2, kMean));
  for (const auto& [first, now] : {std::pair(half, twice), {twice, half}}) {
    const auto kept = result(first, {9, 10});
    const auto again =
        judge_again({.id = "P1", .from = "quick", .conditions = {now}},
                    kept,
                    {planned, planned});
    EXPECT_EQ(again.verdict, kept.verdict);
    EXPECT_EQ(again.evidence, kept.evidence);
  }
}

TEST_F(AsPrinted, WhatIsMadeOfKeptNumbersIsJudgedByThem) {
  const Results plan = campaign("quick", {0, 0, 0, 0});
  const Evidence planned{plan, published_, "toy"};
  const auto again = [&](const std::vector<double>& seeds,
                         const std::string& lost) {
    auto kept = judged(joint_, campaign("quick", seeds), published_);
    std::erase_if(kept.conditions,
                  [&](const ConditionResult& c) { return c.label == lost; });
    return judge_again({.id = "P1", .from = "quick", .conditions = joint_},
                       kept,
                       {planned, planned})
        .verdict;
  };
  EXPECT_EQ(again({48, 50, 52, 54}, "p"), Verdict::reproduced);
  EXPECT_EQ(again({50.5, 52.5, 54.5, 56.5}, "p"), Verdict::not_reproduced);
  // With one part alone, what was decided is kept.
  EXPECT_EQ(again({50.5, 52.5, 54.5, 56.5}, "m"), Verdict::not_reproduced);
}

TEST_F(AsPrinted, WhatWasOnlyReportedIsHeldAgainstABound) {
  const Results plan = campaign("quick", {0, 0});
  const Evidence planned{plan, published_, "toy"};
  const auto kept = result(reported("a", kMean), {9, 10});
  const auto again = [&](const Condition& now) {
    return judge_again({.id = "P1", .from = "quick", .conditions = {now}},
                       kept,
                       {planned, planned})
        .verdict;
  };
  EXPECT_EQ(kept.verdict, Verdict::reported);
  EXPECT_EQ(again(above("a", kMean, 9)), Verdict::reproduced);
  EXPECT_EQ(again(above("a", kMean, 9.6)), Verdict::not_reproduced);
  EXPECT_EQ(again(within("a", kMean, 9, 10)), Verdict::reproduced);
  EXPECT_EQ(again(above("b", kMean, 9)), Verdict::not_judged);
  // The value of a measured bound was not kept.
  EXPECT_EQ(again(above("a", kMean, mean({"b"}, first_loss()))),
            Verdict::not_judged);
}

TEST(Claim, ConditionsOfStagesAreJudgedByWhatIsLeftOfThem) {
  const Published none;
  const Results plan = campaign("quick", {0, 0, 0}),
                left = campaign("quick", {4, 6, 8});
  const Evidence planned{plan, none, "toy"}, stages{left, none, "toy"};
  // Kept under another label, and lower than what the stages have.
  const auto kept = judged({above("before", kMean, 1)}, campaign("quick", {3}));
  const auto again = [&](const Condition& now, const Evidence& of) {
    return judge_again({.id = "P1", .from = "quick", .conditions = {now}},
                       kept,
                       {planned, of});
  };
  const auto found = again(of_stages(above("a", kMean, 5)), stages);
  EXPECT_EQ(found.evidence, "a 6 ± 2 (> 5)");
  EXPECT_EQ(again(of_stages(above("a", kMean, 7)), stages).verdict,
            Verdict::not_reproduced);
  // Without the mark, or without such stages, it waits for a run.
  EXPECT_EQ(again(above("a", kMean, 5), stages).verdict, Verdict::not_judged);
  const Results nothing;
  EXPECT_EQ(
      again(of_stages(above("a", kMean, 5)), {nothing, none, "toy"}).evidence,
      "a: a not run");
  // The one of two that holds counts.
  EXPECT_EQ(again(of_stages(either(above("a", kMean, 7), below("c", kMean, 7))),
                  stages)
                .verdict,
            Verdict::reproduced);
}

TEST(Claim, CasesAreCountedBehindWhatWasDecided) {
  const Results results = campaign("quick", {2, 4, 6});
  const Published none;
  const Evidence evidence{results, none, "toy"};
  const auto cases = [&](std::vector<Condition> conditions) {
    const Claim claim{.id = "P1", .from = "quick", .conditions = conditions};
    return cases_behind(
        claim, judged(std::move(conditions), results), evidence);
  };
  const Condition decided = above("a", kMean, 1),
                  open = above("b", mean({"b"}, first_loss()), 1);
  EXPECT_EQ(cases({decided}), 3);
  EXPECT_EQ(cases({decided, decided}), 6);
  EXPECT_EQ(cases({decided, open, reported("a", kMean)}), 3);
  EXPECT_EQ(cases({open}), 0);
}

TEST(Claim, WhatIsWrongByItself) {
  const Claim good{.id = "P1",
                   .where = "Sec. 4",
                   .from = "quick",
                   .says = "s",
                   .conditions = {reported("a", kMean)}};
  EXPECT_TRUE(errors_of(good, kProfiles).empty());
  const auto broken = [&](auto&& change) {
    Claim claim = good;
    change(claim);
    return errors_of(claim, kProfiles).size();
  };
  EXPECT_EQ(broken([](Claim& c) { c.id.clear(); }), 1U);
  EXPECT_EQ(broken([](Claim& c) { c.says.clear(); }), 1U);
  EXPECT_EQ(broken([](Claim& c) { c.where.clear(); }), 1U);
  EXPECT_EQ(broken([](Claim& c) { c.conditions.clear(); }), 1U);
  EXPECT_EQ(broken([](Claim& c) { c.from = "qick"; }), 1U);
  EXPECT_EQ(broken([](Claim& c) { c.cause = fails("two\nlines"); }), 1U);
  EXPECT_EQ(broken([](Claim& c) { c.cause = depends(""); }), 1U);
  EXPECT_EQ(broken([](Claim& c) {
              c.cause = {Verdict::reproduced, "why"};
            }),
            1U);
}

}  // namespace
}  // namespace physinv
