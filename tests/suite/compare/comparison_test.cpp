#include "suite/compare/comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "suite/compare/pages.h"

namespace physinv {
namespace {

StageRecord stage_with(const std::string& name, double loss, double seconds) {
  StageRecord s;
  s.stage = name;
  s.stop = Stop::converged;
  s.loss = Vector<double>::Constant(3, loss);
  s.status.assign(3, Status::gtol);
  s.clocks.solve.wall = seconds;
  s.counts[Counter::vjp] = 10;
  return s;
}

CaseRecord case_with(const std::string& method,
                     std::uint64_t seed,
                     StageRecord stage) {
  CaseRecord c;
  c.info.experiment = "jpo/sample";
  c.info.method = method;
  c.info.n = 4;
  c.info.seed = seed;
  c.info.stages = {stage.stage};
  c.stages.push_back(std::move(stage));
  return c;
}

Side side(const std::string& label, std::vector<CaseRecord> cases) {
  return {.label = label, .results = Results(std::move(cases)), .claims = {}};
}

std::vector<Side> planted() {
  auto diverged = stage_with("solve", std::nan(""), 1);
  diverged.stop = Stop::diverged;
  return {side("a",
               {case_with("still", 0, stage_with("solve", 1e-3, 1)),
                case_with("worse", 0, stage_with("solve", 1e-3, 1)),
                case_with("slower", 0, stage_with("solve", 1e-3, 1)),
                case_with("ends", 0, stage_with("solve", 1e-3, 1)),
                case_with("gone", 0, stage_with("solve", 1e-3, 1))}),
          side("b",
               {case_with("still", 0, stage_with("solve", 1e-3, 1)),
                case_with("worse", 0, stage_with("solve", 1e-1, 1)),
                case_with("slower", 0, stage_with("solve", 1e-3, 3)),
                case_with("ends", 0, diverged)})};
}

TEST(Compare, WhatChangedMostComesFirst) {
  const Comparison c = compare(planted(), By::seed);
  std::vector<std::string> order;
  for (const auto& row : c.rows) order.push_back(row.id.method);
  EXPECT_EQ(
      order,
      (std::vector<std::string>{"gone", "ends", "worse", "slower", "still"}));
  EXPECT_TRUE(c.rows[0].missing());
  EXPECT_TRUE(c.rows[1].ends_changed());
  EXPECT_DOUBLE_EQ(loss_ratio(*c.rows[2].sides[0], *c.rows[2].sides[1]), 100);
  EXPECT_EQ(c.rows[4].sides[1]->same_bits, 1U);
  EXPECT_EQ(c.rows[2].sides[1]->same_bits, 0U);
}

TEST(Compare, SolvedLossesAreEqual) {
  Reading a, b;
  a.loss = 1e-15, b.loss = 1e-20;
  EXPECT_DOUBLE_EQ(loss_ratio(a, b), 1);
  b.loss = kSolvedLoss * 10;
  EXPECT_DOUBLE_EQ(loss_ratio(a, b), 10);
}

TEST(Compare, AGroupCountsOnlyWhatAllSidesHave) {
  const auto c =
      compare({side("a",
                    {case_with("m", 0, stage_with("solve", 1, 1)),
                     case_with("m", 1, stage_with("solve", 5, 7))}),
               side("b", {case_with("m", 0, stage_with("solve", 2, 1))})},
              By::method);
  ASSERT_EQ(c.rows.size(), 1U);
  EXPECT_EQ(c.rows[0].sides[0]->stages, 1U);
  EXPECT_DOUBLE_EQ(c.rows[0].sides[0]->loss, 1);
  EXPECT_DOUBLE_EQ(c.rows[0].sides[0]->seconds, 1);
}

TEST(Compare, ClaimsThatChangeTheirVerdict) {
  auto sides = planted();
  for (const Verdict v : {Verdict::reproduced, Verdict::not_reproduced}) {
    Side& own = sides[v == Verdict::reproduced ? 0 : 1];
    own.claims.push_back({"jpo/sample", {.id = "R1", .verdict = v}});
    own.claims.push_back(
        {"jpo/sample", {.id = "R2", .verdict = Verdict::reproduced}});
  }
  const auto changed = changed_claims(sides);
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_EQ(changed[0].sides[1]->id, "R1");
  EXPECT_EQ(claims_table(changed, {"a", "b"}).rows[0].cells[1].text, "fails");
}

TEST(Compare, SidesOfRevisions) {
  auto old = stage_with("solve", 1, 1), now = stage_with("solve", 2, 1);
  old.revision = "abc", now.revision = "def";
  const auto sides = sides_by_revision(
      {side("one", {case_with("m", 0, old), case_with("m", 1, now)})});
  ASSERT_EQ(sides.size(), 2U);
  EXPECT_EQ(sides[0].label, "abc");
  EXPECT_EQ(sides[1].results.cases()[0].info.seed, 1U);
}

}  // namespace
}  // namespace physinv
