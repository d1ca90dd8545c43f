#include "suite/compare/comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "suite/compare/pages.h"
#include "suite/compare/regressions.h"
#include "suite/compare/summary.h"

namespace physinv {
namespace {

StageRecord stage_with(const std::string& name, double loss, double seconds) {
  StageRecord s;
  s.stage = name;
  s.stop = Stop::converged;
  s.loss = Vector<double>::Constant(3, loss);
  s.status.assign(3, Status::gtol);
  s.clocks.solve = {.wall = seconds, .cpu = seconds};
  s.run.threads = 1;
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
      (std::vector<std::string>{"ends", "worse", "slower", "still", "gone"}));
  EXPECT_TRUE(c.rows[4].missing());
  EXPECT_TRUE(c.rows[0].ends_changed());
  EXPECT_DOUBLE_EQ(loss_ratio(*c.rows[1].sides[0], *c.rows[1].sides[1]), 100);
  EXPECT_EQ(c.rows[3].sides[1]->same_bits, 1U);
  EXPECT_EQ(c.rows[1].sides[1]->same_bits, 0U);
}

TEST(Compare, WhatASideLacksIsALinePerExperiment) {
  const Comparison c = compare(planted(), By::seed);
  EXPECT_EQ(common(c).rows.size(), 4U);
  const Table table = missing_table(c);
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0].label, c.rows[4].id.experiment);
  EXPECT_EQ(table.rows[0].cells[0].ours, 0);
  EXPECT_EQ(table.rows[0].cells[1].ours, 1);
  EXPECT_TRUE(missing_table(common(c)).rows.empty());
  for (const Section& s :
       compare_sections(c, planted(), {}, side_ranks(planted())))
    for (const Table& t : s.tables) EXPECT_NE(t.id, "claims") << "no claim";
}

TEST(Compare, WhatASideDoesNotJudgeDidNotChange) {
  const auto judged = [](Verdict a, Verdict b) {
    ClaimResult one{.id = "P1", .verdict = a}, other{.id = "P1", .verdict = b};
    return judged_everywhere({{.experiment = "e", .sides = {one, other}}})
        .size();
  };
  EXPECT_EQ(judged(Verdict::reproduced, Verdict::not_reproduced), 1U);
  EXPECT_EQ(judged(Verdict::reproduced, Verdict::not_judged), 0U);
  EXPECT_EQ(judged(Verdict::not_judged, Verdict::reproduced), 0U);
  EXPECT_TRUE(judged_everywhere(
                  {{.experiment = "e", .sides = {ClaimResult{.id = "P1"}, {}}}})
                  .empty());
}

/// Of one method on 20 examples whose losses are these.
Side side_of_losses(const char* label, double first, double last) {
  StageRecord stage = stage_with("solve", 1, 1);
  stage.loss = Vector<double>::LinSpaced(20, first, last);
  return side(label, {case_with("m", 0, stage)});
}

TEST(Compare, ALowerLossOnTheSameProblemsIsTested) {
  const std::vector<Side> sides{side_of_losses("a", 1, 2),
                                side_of_losses("b", 0.5, 1),
                                side_of_losses("c", 1, 2)};
  const auto ranks = side_ranks(sides);
  ASSERT_EQ(ranks.size(), 2U);
  EXPECT_EQ(ranks[0].side, 1U);
  EXPECT_TRUE(ranks[0].differs());
  EXPECT_TRUE(ranks[0].better());
  EXPECT_EQ(ranks[0].test.below, 20U);
  EXPECT_EQ(ranks[1].test.ties, 20U);
  EXPECT_FALSE(ranks[1].differs());
  const Comparison c = compare(sides, By::seed);
  const auto lines = summary_sentences(method_changes(c, ranks), c);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_TRUE(lines[0].starts_with(
      "b against a: lower losses: m (on 100 % of 20 problems, p "))
      << lines[0];
  EXPECT_EQ(lines[1],
            "c against a: no method got better or worse; 1 of 1 methods "
            "unchanged");
  const Table table = rank_table(ranks, {"a", "b", "c"}, 1);
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0].cells[5].text, "lower");
}

/// Of 20 examples, of which `solved` have a tiny loss and the others 0.5.
CaseRecord two_peaked(Index solved, double seconds) {
  StageRecord stage = stage_with("solve", 0.5, seconds);
  stage.loss = Vector<double>::Constant(20, 0.5);
  stage.loss.head(solved).setConstant(1e-11);
  return case_with("m", 0, stage);
}

TEST(Compare, BetweenTwoPeaksTheShareSolvedIsShown) {
  for (const By by : {By::seed, By::method}) {
    const Comparison c = compare(
        {side("a", {two_peaked(12, 1)}), side("b", {two_peaked(9, 1)})}, by);
    const Table table = changes_table(c, 1);
    EXPECT_EQ(table.rows[0].cells[2].text, "solved 60 → 45 %");
    EXPECT_NEAR(*table.rows[0].cells[2].ours, 0.5 / 1e-11, 1) << "in CSV";
    const Table methods = method_table(method_changes(c, {}), c, 9);
    EXPECT_EQ(methods.rows.at(0).cells[0].text, "60 %");
    EXPECT_EQ(methods.rows[0].cells[1].text, "45 %");
  }
  // The medians are of one peak: the ratio stays, and the share is a change.
  const Comparison c = compare(
      {side("a", {two_peaked(3, 1)}), side("b", {two_peaked(2, 1)})}, By::seed);
  EXPECT_EQ(changes_table(c, 1).rows[0].cells[2].text, "=");
  EXPECT_EQ(changed(c).rows.size(), 1U);
}

TEST(Compare, NothingBelowTenMillisecondsIsSlower) {
  const auto of = [](double before, double after) {
    return compare(
        {side("a", {two_peaked(3, before)}), side("b", {two_peaked(3, after)})},
        By::seed);
  };
  const Comparison brief = of(2e-3, 9e-3);
  EXPECT_EQ(changes_table(brief, 1).rows[0].cells[3].text, "=");
  EXPECT_EQ(unchanged_text(brief), "1 of 1 rows unchanged");
  EXPECT_TRUE(folded_table(brief, 9).rows.empty());
  EXPECT_TRUE(method_table(method_changes(brief, {}), brief, 9).rows.empty());
  const Comparison slower = of(2e-3, 3e-2);
  EXPECT_EQ(changes_table(slower, 1).rows[0].cells[3].text, "×3");
  EXPECT_EQ(unchanged_text(slower), "0 of 1 rows unchanged");
  EXPECT_EQ(summary_sentences(method_changes(slower, {}), slower),
            std::vector<std::string>{
                "b against a: slower: m (×3); 0 of 1 methods unchanged"});
}

TEST(Compare, WhoFailedHasTheHighestLoss) {
  std::vector<Side> sides{side_of_losses("a", 1, 2), side_of_losses("b", 1, 2)};
  auto cases = sides[1].results.cases();
  cases[0].stages[0].loss.resize(0);
  sides[1].results = Results(cases);
  const auto ranks = side_ranks(sides);
  ASSERT_EQ(ranks.size(), 1U);
  EXPECT_TRUE(ranks[0].differs());
  EXPECT_FALSE(ranks[0].better());
  // On the first side, too.
  std::swap(sides[0], sides[1]);
  auto failed = sides[0].results.cases();
  failed[0].stages[0].stop = Stop::failed;
  sides[0].results = Results(failed);
  const auto first = side_ranks(sides);
  ASSERT_EQ(first.size(), 1U);
  EXPECT_TRUE(first[0].better());
  EXPECT_EQ(first[0].test.below, 20U);
  std::swap(sides[0], sides[1]);
  cases[0].stages[0].loss = Vector<double>::Ones(3);
  sides[1].results = Results(cases);
  EXPECT_TRUE(side_ranks(sides).empty()) << "not the same problems";
}

TEST(Compare, SolvedLossesAreEqual) {
  Reading a, b;
  a.loss.median = 1e-15, b.loss.median = 1e-20;
  EXPECT_DOUBLE_EQ(loss_ratio(a, b), 1);
  b.loss.median = kEqualLoss * 10;
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
  EXPECT_DOUBLE_EQ(c.rows[0].sides[0]->loss.median, 1);
  EXPECT_DOUBLE_EQ(c.rows[0].sides[0]->times->cpu.median, 1);
  EXPECT_TRUE(regression(Aspect::missing, c, {}, 1.5))
      << "a group without one of its runs";
}

TEST(Compare, AMedianOfTimesSaysOfHowManyItIs) {
  auto failed = stage_with("solve", NAN, 1);
  failed.stop = Stop::failed;
  const std::vector<Side> sides{
      side("a",
           {case_with("m", 0, stage_with("solve", 1, 2)),
            case_with("m", 1, stage_with("solve", 1, 2))}),
      side("b",
           {case_with("m", 0, failed),
            case_with("m", 1, stage_with("solve", 1, 3))})};
  const Comparison c = compare(sides, By::method);
  const auto tables = detail_tables(c);
  EXPECT_EQ(tables[0].id, "times");
  EXPECT_EQ(tables[0].rows[0].cells[0].text, "2000");
  EXPECT_EQ(tables[0].rows[0].cells[1].text, "3000 (1 of 2)");
  const auto sections =
      compare_sections(compare(sides, By::seed), sides, {}, {});
  EXPECT_EQ(sections[1].figures[0].note,
            "Without 1 points of stages that failed, diverged or have no "
            "finite median loss.");
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
  EXPECT_EQ(claims_table(changed, {"a", "b"}).rows[0].cells[1].text,
            "not reproduced");
}

StageRecord ended(Stop stop, double loss = std::nan("")) {
  StageRecord s =
      stage_with("solve", loss, has_result(StageRecord{.stop = stop}) ? 1 : 0);
  s.stop = stop;
  if (stop == Stop::failed) s.loss.resize(0), s.status.clear();
  return s;
}

Comparison of_two(StageRecord a, StageRecord b) {
  return compare({side("a", {case_with("m", 0, std::move(a))}),
                  side("b", {case_with("m", 0, std::move(b))})},
                 By::seed);
}

std::optional<Regression> found(Aspect aspect, StageRecord a, StageRecord b) {
  return regression(aspect, of_two(std::move(a), std::move(b)), {}, 1.5);
}

TEST(Compare, AStageThatFailedHasNoTime) {
  const auto good = stage_with("solve", 1e-3, 1);
  for (const Stop stop : {Stop::diverged, Stop::failed, Stop::skipped}) {
    const auto lost = ended(stop);
    for (const Aspect cost : {Aspect::time, Aspect::work}) {
      const auto worse = found(cost, good, lost);
      ASSERT_TRUE(worse) << to_string(stop);
      EXPECT_FALSE(worse->of_time);
      EXPECT_NE(worse->worst.find(to_string(stop)), std::string::npos);
      EXPECT_FALSE(found(cost, lost, good)) << to_string(stop);
      EXPECT_FALSE(found(cost, lost, lost)) << to_string(stop);
    }
    const auto table = changes_table(of_two(good, lost), 1);
    EXPECT_EQ(table.rows[0].cells[3].text, to_string(stop));
    EXPECT_FALSE(table.rows[0].cells[3].ours);
  }
}

TEST(Compare, EndsAreOrdered) {
  const std::vector<StageRecord> best_first = {ended(Stop::converged, 1e-3),
                                               ended(Stop::iterations, 1e-3),
                                               ended(Stop::diverged),
                                               ended(Stop::failed)};
  for (std::size_t i = 0; i < best_first.size(); ++i)
    for (std::size_t k = 0; k < best_first.size(); ++k)
      EXPECT_EQ(found(Aspect::status, best_first[i], best_first[k]).has_value(),
                k > i)
          << i << " " << k;
}

TEST(Compare, ExamplesAreOrdered) {
  using Counts = StatusCounts;  // gtol, maxiter, linesearch, nonfinite, ftol
  EXPECT_EQ(direction(Counts{3, 1, 0, 0}, Counts{4, 0, 0, 0}),
            Direction::better);
  EXPECT_EQ(direction(Counts{4, 0, 0, 0}, Counts{3, 0, 1, 0}),
            Direction::worse);
  EXPECT_EQ(direction(Counts{3, 1, 0, 0}, Counts{3, 0, 1, 0}),
            Direction::other);
  EXPECT_EQ(direction(Counts{2, 2, 0, 0}, Counts{3, 0, 0, 1}),
            Direction::worse);
  EXPECT_EQ(direction(Counts{3, 1}, Counts{0, 1, 0, 0, 3}), Direction::other);
  EXPECT_EQ(direction(Counts{3, 1}, Counts{3, 0, 0, 0, 1}), Direction::better);
  EXPECT_EQ(direction(Counts{0, 0, 0, 0, 1}, Counts{0, 0, 1}),
            Direction::worse);
  EXPECT_EQ(direction(Stop::failed, Stop::skipped), Direction::other);
}

TEST(Compare, OneOfFourRunsIsSeenInAPool) {
  std::vector<CaseRecord> before, after;
  for (const std::uint64_t seed : {0, 1, 2, 3}) {
    before.push_back(case_with("m", seed, stage_with("solve", 4.5e-12, 1)));
    after.push_back(case_with(
        "m", seed, stage_with("solve", seed == 2 ? 2.5e-1 : 4e-12, 1)));
  }
  const auto c = compare({side("a", before), side("b", after)}, By::method);
  ASSERT_EQ(c.rows.size(), 1U);
  const auto worse = regression(Aspect::loss, c, {}, 1.5);
  ASSERT_TRUE(worse);
  EXPECT_EQ(worse->worse, 1U);
  EXPECT_EQ(worse->judged, 4U);
  EXPECT_NE(worse->worst.find("seed=2"), std::string::npos);
  EXPECT_FALSE(regression(Aspect::time, c, {}, 1.5));
  const auto table = changes_table(c, 1);
  const auto& cells = table.rows[0].cells;
  EXPECT_EQ(table.columns[cells.size() - 2], "wins");
  EXPECT_EQ(cells[cells.size() - 2].text, "3 of 4");
  EXPECT_EQ(cells.back().text, "n=4/seed=2 solved 100 → 0 %");
  EXPECT_TRUE(cells[0].spread && cells[2].spread && cells[3].spread);
  EXPECT_GT(c.rows[0].change(), 10) << "not first of what changed";
}

TEST(Compare, OnOneThreadCpuTimeIsCompared) {
  auto quiet = stage_with("solve", 1e-3, 1), busy = quiet;
  busy.clocks.solve = {.wall = 9, .cpu = 1.1};
  busy.crowded = true;
  EXPECT_FALSE(found(Aspect::time, quiet, busy));
  quiet.run.threads = busy.run.threads = 2;
  const auto c = of_two(quiet, busy);
  EXPECT_EQ(changes_table(c, 1).rows[0].cells[3].text, "crowded");
  const auto undecided = regression(Aspect::time, c, {}, 1.5);
  ASSERT_TRUE(undecided) << "nothing passes because nothing was judged";
  EXPECT_NE(undecided->text().find("1 crowded"), std::string::npos);
}

TEST(Compare, RepetitionsAreRead) {
  const auto stage = stage_with("solve", 1e-3, 5);  // the first, cold
  auto again = stage;
  again.repeated = {{1, 1}, {1.1, 1.1}, {1.2, 1.2}};
  std::vector<Side> sides = {side("a", {case_with("m", 0, stage)}),
                             side("b", {case_with("m", 0, again)})};
  const auto c = compare(sides, By::seed);
  EXPECT_DOUBLE_EQ(c.rows[0].sides[1]->times->cpu.median, 1.15);
  EXPECT_TRUE(detail_tables(c)[0].rows[0].cells[1].spread);
  EXPECT_FALSE(regression(Aspect::time, c, {}, 1.5));
  std::swap(sides[0], sides[1]);
  EXPECT_TRUE(regression(Aspect::time, compare(sides, By::seed), {}, 1.5));
}

TEST(Compare, WhatWasNotCountedIsNoZero) {
  auto before = stage_with("solve", 1e-3, 1), now = before;
  before.counts.forget(Counter::skipped_terms);
  now.counts[Counter::skipped_terms] = 7;
  const auto tables =
      detail_tables(compare({side("a", {case_with("m", 0, before)}),
                             side("b", {case_with("m", 0, now)})},
                            By::seed));
  const auto table =
      std::find_if(tables.begin(), tables.end(), [](const Table& t) {
        return t.title == "skipped_terms";
      });
  ASSERT_NE(table, tables.end());
  EXPECT_EQ(table->rows[0].cells[0].text, "not counted");
  EXPECT_EQ(table->rows[0].cells[1].ours, 7);
}

TEST(Compare, ClaimsGetWorseInOneDirection) {
  const auto worse = [](Verdict from, Verdict to) {
    auto sides = planted();
    sides[0].claims = {{"e", {.id = "R", .verdict = from}}};
    sides[1].claims = {{"e", {.id = "R", .verdict = to}}};
    return regression(Aspect::claims, {}, changed_claims(sides), 1.5)
        .has_value();
  };
  using enum Verdict;
  EXPECT_TRUE(worse(reproduced, not_judged));
  EXPECT_TRUE(worse(reproduced, not_reproduced));
  EXPECT_TRUE(worse(not_judged, not_reproduced));
  EXPECT_FALSE(worse(not_reproduced, not_judged));
  EXPECT_FALSE(worse(not_reproduced, reproduced));
  EXPECT_FALSE(worse(not_judged, reproduced));
  // Partly judged is nearly reproduced, explained is nearly failed.
  EXPECT_TRUE(worse(reproduced, partly_judged));
  EXPECT_TRUE(worse(partly_judged, not_judged));
  for (const Verdict explained : {stronger, weaker, depends, contradiction}) {
    EXPECT_TRUE(worse(reproduced, explained));
    EXPECT_TRUE(worse(explained, not_reproduced));
    EXPECT_TRUE(worse(partly_judged, explained));
    EXPECT_FALSE(worse(explained, not_judged));
    EXPECT_FALSE(worse(not_reproduced, explained));
    EXPECT_FALSE(worse(stronger, explained));
  }
}

TEST(Compare, NoColumnIsAsWideAsAPath) {
  const std::string long_path(200, 'p');
  auto sides = planted();
  sides[1].label = long_path + "/é";
  const auto head = [&] {
    return changes_table(compare(sides, By::seed), 1).columns[1];
  };
  EXPECT_LT(head().size(), 40U);
  EXPECT_NE(head().find("…"), std::string::npos);
  EXPECT_TRUE(head().ends_with("p/é"));
  sides[0].label = long_path + "p/é";  // the same when shortened
  EXPECT_EQ(head(), "loss " + sides[1].label);
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
