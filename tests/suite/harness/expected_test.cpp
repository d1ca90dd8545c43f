#include "suite/harness/expected.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "suite/harness/errors.h"
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
