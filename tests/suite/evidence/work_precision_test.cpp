#include "suite/evidence/work_precision.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/suite/evidence/campaigns.h"

namespace physinv {
namespace {

/// A chain of one stage with these mean losses of two alike examples, point k
/// after `step` (k + 1) seconds of the batch.
CaseRecord history(const std::string& method,
                   std::uint64_t seed,
                   const std::vector<double>& means,
                   double step) {
  StageRecord s = stage_of("solve", {means.back(), means.back()});
  s.curve.loss.resize(2, static_cast<Index>(means.size()));
  for (std::size_t k = 0; k < means.size(); ++k) {
    s.curve.iteration.push_back(static_cast<double>(k));
    s.curve.seconds.push_back(step * static_cast<double>(k + 1));
    s.curve.evaluations.push_back(1);
    s.curve.loss.col(static_cast<Index>(k)).setConstant(means[k]);
  }
  s.clocks.solve.wall = step * static_cast<double>(means.size());
  return case_of(method, 2, seed, {"solve"}, {s});
}

// Slow and good, fast and rough, and one that is both slow and rough. The start
// of seed 1 is twice as high, everything else is alike.
Results three_methods() {
  return Results({history("good", 0, {1, 0.5, 0.01}, 10),
                  history("good", 1, {2, 1, 0.02}, 10),
                  history("fast", 0, {1, 0.4, 0.3}, 1),
                  history("fast", 1, {2, 0.8, 0.6}, 1),
                  history("poor", 0, {1, 0.9, 0.8}, 20),
                  history("poor", 1, {2, 1.8, 1.6}, 20),
                  history("poor", 2, {2, 1.8, 1e-9}, 20)});
}

TEST(WorkPrecision, MediansArePairedAndRelativeToTheStart) {
  const auto settings = setting_histories(three_methods(), "toy");
  ASSERT_EQ(settings.size(), 3U);
  const SettingHistory& poor = settings[2];
  EXPECT_EQ(poor.method, "poor");
  EXPECT_EQ(poor.seeds, 2U);  // no other method has the third
  EXPECT_DOUBLE_EQ(poor.points.back().loss, 0.8);
  EXPECT_DOUBLE_EQ(poor.points.back().seconds, 30);  // of two problems
  EXPECT_DOUBLE_EQ(poor.points.front().loss, 1);
  // Estimates are 1, the truth is 0.25, in both unknowns.
  EXPECT_DOUBLE_EQ(poor.distance.value(), 0.75 * std::sqrt(2.0));
}

TEST(WorkPrecision, HullAndTargets) {
  const auto settings = setting_histories(three_methods(), "toy");
  const auto hull = work_precision_hull(settings);
  ASSERT_EQ(hull.size(), 4U);
  EXPECT_DOUBLE_EQ(hull[1].loss, 0.4);
  EXPECT_DOUBLE_EQ(hull.back().loss, 0.01);
  EXPECT_TRUE(on_hull(settings[0], hull));
  EXPECT_TRUE(on_hull(settings[1], hull));
  EXPECT_FALSE(on_hull(settings[2], hull));
  EXPECT_DOUBLE_EQ(seconds_to(settings[0], 0.4), 1);
  EXPECT_DOUBLE_EQ(seconds_to(settings[1], 0.4), 15);
  EXPECT_EQ(seconds_to(settings[2], 0.4), HUGE_VAL);
}

TEST(WorkPrecision, TheReportNamesWhatIsDominated) {
  Section section;
  add_work_precision(section, three_methods(), "toy", {{"poor", "Poor"}});
  ASSERT_EQ(section.tables.size(), 1U);
  EXPECT_NE(
      section.tables[0].note.find("Dominated at every budget: Poor, n = 2"),
      std::string::npos)
      << section.tables[0].note;
  ASSERT_EQ(section.figures.size(), 1U);
  EXPECT_EQ(section.figures[0].panels.size(), 2U);
  EXPECT_EQ(section.figures[0].panels[0].series.size(), 4U);
}

/// A run that fails after so many seconds, at once or behind its stage.
CaseRecord failing(CaseRecord c, double seconds, bool at_once) {
  StageRecord lost{.stage = "refine", .stop = Stop::failed};
  lost.clocks.setup.wall = seconds > 0 ? 1 : 0;
  lost.clocks.solve.wall = seconds;
  if (at_once) c.stages.clear();
  c.stages.push_back(lost);
  return c;
}

TEST(WorkPrecision, FailedRunsAreInTheMedians) {
  const auto of = [](bool at_once, double seconds) {
    std::vector<CaseRecord> cases;
    for (const std::uint64_t seed : {0, 1, 2}) {
      cases.push_back(history("good", seed, {1, 0.5, 0.1}, 10));
      CaseRecord c = history("frail", seed, {1, 0.5, 0.01}, 1);
      cases.push_back(seed == 0 ? failing(c, seconds, at_once) : c);
    }
    return setting_histories(Results(cases), "toy");
  };
  for (const bool at_once : {false, true}) {
    const auto settings = of(at_once, 100);
    const SettingHistory &frail = settings[0], &good = settings[1];
    EXPECT_EQ(good.seeds, 3U) << "no seed is lost to the others";
    EXPECT_EQ(frail.seeds, 3U);
    EXPECT_EQ(frail.failed, 1U);
    EXPECT_DOUBLE_EQ(frail.end.loss, 0.01);
    EXPECT_EQ(frail.end.high, HUGE_VAL);
    EXPECT_TRUE(std::isfinite(*frail.distance));
    // A method that lost a process has no seconds.
    EXPECT_TRUE(of(at_once, 0)[0].points.empty());
    EXPECT_FALSE(of(at_once, 0)[1].points.empty());
  }
}

TEST(WorkPrecision, WhereMostRunsFailThereIsNoLossAtTheEnd) {
  std::vector<CaseRecord> cases;
  for (const std::uint64_t seed : {0, 1, 2}) {
    cases.push_back(history("good", seed, {1, 0.5, 0.1}, 10));
    const CaseRecord c = history("frail", seed, {1, 0.5, 0.01}, 1);
    cases.push_back(seed == 0 ? c : failing(c, 100, false));
  }
  const Results results(cases);
  const auto frail = setting_histories(results, "toy")[0];
  EXPECT_EQ(frail.end.loss, HUGE_VAL);
  EXPECT_EQ(*frail.distance, HUGE_VAL);
  EXPECT_DOUBLE_EQ(frail.points.back().loss, 0.01) << "before they fail";
  Section section;
  add_work_precision(section, results, "toy", {});
  const Table& table = section.tables[0];
  EXPECT_EQ(table.rows[0].cells[2].text, "not finite");
  EXPECT_NE(table.note.find("frail, n = 2 2 of 3 failed"), std::string::npos)
      << table.note;
}

TEST(WorkPrecision, AnEstimateThatIsNotFiniteIsFar) {
  std::vector<CaseRecord> cases;
  for (const std::uint64_t seed : {0, 1, 2}) {
    cases.push_back(history("a", seed, {1, 0.5}, 1));
    if (seed > 0) cases.back().stages[0].x.setConstant(NAN);
  }
  EXPECT_EQ(*setting_histories(Results(cases), "toy")[0].distance, HUGE_VAL);
}

TEST(WorkPrecision, WithoutLossesThereIsNoReport) {
  Section section;
  add_work_precision(section, Results{}, "toy", {});
  auto diverged = history("good", 0, {1, 0.5}, 1);
  diverged.stages[0].curve.loss.setConstant(NAN);
  diverged.stages[0].loss.setConstant(NAN);
  add_work_precision(section, Results({diverged}), "toy", {});
  auto looks = history("look", 0, {1, 0.5}, 1);
  looks.stages[0].options = {{"algorithm", "diagnostic"}};
  add_work_precision(section, Results({looks}), "toy", {});
  EXPECT_TRUE(section.tables.empty());
}

}  // namespace
}  // namespace physinv
