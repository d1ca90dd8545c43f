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
// of seed 1 is twice as high, all else is alike.
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
  EXPECT_EQ(poor.seeds, 2U);  // the third is nobody else's
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
