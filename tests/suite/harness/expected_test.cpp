#include "suite/harness/expected.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "suite/evidence/quantity.h"
#include "suite/harness/errors.h"
#include "suite/harness/judge.h"
#include "suite/results/verdict_words.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

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

TEST(Expected, OnlyNewMissesCount) {
  const auto j = compare(sections(), {}, "quick");
  EXPECT_EQ(j.judged, 2u);
  EXPECT_EQ(j.misses, Names{"a/b R2: R2 is so"});
  const auto known =
      compare(sections(), {{"a/b", "R2", "too few", ""}}, "quick");
  EXPECT_EQ(known.misses, Names{});
  EXPECT_EQ(known.known_misses, Names{"a/b R2: too few"});
}

TEST(Expected, WhatItsCauseExplainsStandsInNoList) {
  auto all = sections();
  ClaimResult& missed = all[0].claims[1];
  missed.cause = "a choice";
  for (const Verdict v :
       {Verdict::depends, Verdict::differs, Verdict::contradiction}) {
    missed.verdict = v;
    const auto j = compare(all, {}, "quick");
    EXPECT_EQ(j.judged, 2u);
    EXPECT_EQ(j.misses, Names{});
    EXPECT_EQ(
        j.explained,
        Names{fmt::format("a/b R2: {}: a choice", words_of(v, Origin::suite))});
  }
}

TEST(Expected, AClaimsCauseIsItsReason) {
  auto all = sections();
  const std::vector<ExpectedFailure> list = {{"a/b", "R2", "", ""}};
  const Registry none;
  EXPECT_THROW(check_expected(list, none, all, "file"), UsageError);
  all[0].claims[1].cause = "too few";
  EXPECT_NO_THROW(check_expected(list, none, all, "file"));
  EXPECT_EQ(compare(all, list, "quick").known_misses, Names{"a/b R2: too few"});
  // One that holds all the same is said.
  all[0].claims[0].cause = "an old story";
  EXPECT_EQ(compare(all, list, "quick").stale, Names{"a/b R1: an old story"});
}

TEST(Expected, ProfileOfAnEntryCounts) {
  const std::vector<ExpectedFailure> list = {{"a/b", "R2", "why", "paper"}};
  EXPECT_EQ(compare(sections(), list, "quick").misses.size(), 1u);
  EXPECT_EQ(compare(sections(), list, "paper").misses.size(), 0u);
}

TEST(Expected, ClaimThatHoldsIsNamed) {
  const auto j = compare(sections(), {{"a/b", "R1", "why", ""}}, "quick");
  EXPECT_EQ(j.surprises, Names{"a/b R1: R1 is so"});
}

TEST(Expected, OtherProgramsTakeWhatTheyKnow) {
  Registry some;
  some.add(Experiment{.name = "a/b"});
  some.add(Overview{.paper = "c"});
  const auto known = known_to(some,
                              {{"a/b", "R9", "why", ""},
                               {"other/b", "R1", "why", ""},
                               {"c", "P1", "why", ""}});
  ASSERT_EQ(known.size(), 2U);
  EXPECT_EQ(known[0].claim, "R9");
  EXPECT_EQ(known[1].experiment, "c");
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

TEST(Expected, WhatIsRegisteredAloneIsDecidedByNoRun) {
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
    EXPECT_EQ(compare({s}, {}, "quick").judged,
              results.cases().empty() ? 0U : 1U);
    return decided_by_runs(registry, {s}, results, none);
  };
  EXPECT_EQ(decided({constant}, one_run()), 0U);
  EXPECT_EQ(decided({constant, measured}, one_run()), 1U);
  EXPECT_EQ(decided({measured}, one_run()), 1U);
  EXPECT_EQ(decided({measured}, Results()), 0U);
  // Made while it reports: nobody knows from what.
  EXPECT_EQ(decided_by_runs(Registry(), sections(), one_run(), {}), 2U);
}

TEST(Expected, EntryWithoutAClaimIsAnError) {
  const Registry none;
  EXPECT_NO_THROW(
      check_expected({{"a/b", "R3", "why", ""}}, none, sections(), "file"));
  for (const ExpectedFailure& wrong : {ExpectedFailure{"a/b", "R9", "why", ""},
                                       ExpectedFailure{"a/c", "R1", "why", ""}})
    EXPECT_THROW(check_expected({wrong}, none, sections(), "file"), UsageError);
}

TEST(Expected, FileIsReadOrRefused) {
  const fs::path path = fs::temp_directory_path() / "physinv-expected.json";
  const auto read = [&](const std::string& text) {
    std::ofstream(path) << text;
    return read_expected(path);
  };
  const auto list = read(R"({"expected": [
    {"experiment": "a/b", "claim": "R2", "reason": "why"}]})");
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0].reason, "why");
  for (const char* wrong :
       {"",
        "{}",
        R"({"expected": [{"experiment": "a/b"}]})",
        R"({"expected": [{"experiment": "a", "claim": "b", "reason": ""}]})"})
    EXPECT_THROW(read(wrong), UsageError) << wrong;
  fs::remove(path);
}

}  // namespace
}  // namespace physinv
