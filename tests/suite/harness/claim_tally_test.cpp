#include "suite/harness/claim_tally.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "suite/evidence/quantity.h"
#include "suite/harness/errors.h"
#include "suite/harness/judge.h"
#include "suite/results/verdict_words.h"

namespace physinv {
namespace {

ClaimResult claim(const std::string& id, Verdict verdict, bool gates = true) {
  ClaimResult c;
  c.id = id, c.says = id + " is so", c.verdict = verdict, c.gates = gates;
  return c;
}

std::vector<Section> sections() {
  Section s;
  s.experiment = "a/b";
  s.claims = {claim("R1", Verdict::reproduced),
              claim("R2", Verdict::not_reproduced),
              claim("R3", Verdict::not_judged),
              claim("R4", Verdict::not_reproduced, false)};
  return {s};
}

using Names = std::vector<std::string>;

TEST(ClaimTally, OnlyNewMissesCount) {
  const auto j = tally(sections(), {});
  EXPECT_EQ(j.judged, 2u);
  EXPECT_EQ(j.misses, Names{"a/b R2: R2 is so"});
  const auto known = tally(sections(), {"a/b R2"});
  EXPECT_EQ(known.misses, Names{});
  EXPECT_EQ(known.known_misses, Names{"a/b R2: R2 is so"});
}

TEST(ClaimTally, WhatItsCauseExplainsIsNoMiss) {
  auto all = sections();
  ClaimResult& missed = all[0].claims[1];
  missed.cause = "a choice";
  for (const Verdict v : {Verdict::depends,
                          Verdict::stronger,
                          Verdict::weaker,
                          Verdict::differs,
                          Verdict::contradiction}) {
    missed.verdict = v;
    const auto j = tally(all, {});
    EXPECT_EQ(j.judged, 2u);
    EXPECT_EQ(j.misses, Names{});
    EXPECT_EQ(j.explained,
              Names{fmt::format("a/b R2: {}: a choice", words_of(v))});
  }
}

TEST(ClaimTally, AMissThatStatesItsCauseIsKnown) {
  auto all = sections();
  all[0].claims[1].cause = "too few";
  const auto known = tally(all, {});
  EXPECT_EQ(known.misses, Names{});
  EXPECT_EQ(known.known_misses, Names{"a/b R2: too few"});
  // One that still holds is reported.
  all[0].claims[0].cause = "an old story";
  EXPECT_EQ(tally(all, {}).stale, Names{"a/b R1: an old story"});
}

TEST(ClaimTally, ACauseThatDoesNotShowIsNone) {
  auto all = sections();
  ClaimResult& missed = all[0].claims[1];
  missed.cause = "the same direction (which does not show here: x 1 (> 2: no))";
  missed.shown_by = {{.label = "y", .bounds = "> 0", .missing = "not run"}};
  EXPECT_EQ(tally(all, {}).misses, Names{});
  missed.shown_by.push_back({.label = "x", .bounds = "> 2", .holds = false});
  EXPECT_EQ(tally(all, {}).misses, Names{"a/b R2: R2 is so"});
}

TEST(ClaimTally, ClaimThatHoldsIsNamed) {
  EXPECT_EQ(tally(sections(), {"a/b R1"}).surprises, Names{"a/b R1: R1 is so"});
}

/// A case of experiment a/b, whose method "m" ends with this loss.
Results one_run() {
  CaseRecord c;
  c.info.experiment = "a/b", c.info.method = "m", c.info.stages = {"solve"};
  c.stages.push_back({.stage = "solve", .loss = Vector<double>::Ones(1)});
  return Results({c});
}

RunValue first_loss() {
  return [](const Run& run) { return std::optional(run.stage->loss(0)); };
}

TEST(ClaimTally, WhatIsRegisteredAloneIsDecidedByNoRun) {
  const Condition constant = equals("parameters", Quantity(3.0), 3),
                  measured = above("loss", median({"m"}, first_loss()), 0);
  const auto decided = [](std::vector<Condition> conditions,
                          const Results& results) {
    Registry registry;
    registry.add(Experiment{
        .name = "a/b",
        .profiles = {{"quick", {}}},
        .claims = {{.id = "R1", .says = "so", .conditions = conditions}}});
    const Published none;
    Section s{.experiment = "a/b"};
    s.claims = judge(*registry.find("a/b"), results, none);
    EXPECT_EQ(tally({s}, {}).judged, results.cases().empty() ? 0U : 1U);
    return decided_by_runs(registry, {s}, results, none);
  };
  EXPECT_EQ(decided({constant}, one_run()), 0U);
  EXPECT_EQ(decided({constant, measured}, one_run()), 1U);
  EXPECT_EQ(decided({measured}, one_run()), 1U);
  EXPECT_EQ(decided({measured}, Results()), 0U);
  // Made while it reports: its source is not known.
  EXPECT_EQ(decided_by_runs(Registry(), sections(), one_run(), {}), 2U);
}

TEST(ClaimTally, NamesAreThoseOfClaims) {
  Registry registry;
  registry.add(Experiment{.name = "a/c", .claims = {{.id = "R1"}}});
  registry.add(Overview{.paper = "p", .claims = {{.id = "P1"}}});
  const auto names = [&](const std::string& text) {
    return expected_to_fail(text, registry, sections());
  };
  EXPECT_EQ(names(""), Names{});
  EXPECT_EQ(names("a/b R3, a/c R1 ,p P1"), (Names{"a/b R3", "a/c R1", "p P1"}));
  for (const char* wrong :
       {"a/b R9", "a/d R1", "a/b", "R3", "a/b R3 a/c R1", "a/b R3,, a/c R1"})
    EXPECT_THROW(names(wrong), UsageError) << wrong;
}

}  // namespace
}  // namespace physinv
