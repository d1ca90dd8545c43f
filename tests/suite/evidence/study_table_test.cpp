#include "suite/evidence/study_table.h"

#include <gtest/gtest.h>

#include "suite/results/published.h"
#include "tests/suite/evidence/campaigns.h"

namespace physinv {
namespace {

/// Of its one example.
RunValue own_loss() {
  return [](const Run& run) { return std::optional(run.stage->loss[0]); };
}

TEST(StudyTable, AsksEveryColumnOfEverySetting) {
  const Results results({case_of("a", 1, 0, {"fit"}, {stage_of("fit", {2})}),
                         case_of("b", 1, 0, {"fit"}, {stage_of("fit", {9})})});
  const Published none;
  const StudyTable<std::string> study{
      .settings = {"a", "b"},
      .columns = {{"loss (above 5)",
                   [](const std::string& m) {
                     return lowest(Select{m}, own_loss());
                   },
                   asks_above(5)},
                  {"twice",
                   [](const std::string& m) {
                     return times(2, lowest(Select{m}, own_loss()));
                   }}},
      .title = [](const std::string& m) { return "method " + m; }};
  const auto conditions = study.conditions();
  ASSERT_EQ(conditions.size(), 4U);
  EXPECT_EQ(conditions[2].label, "method b: loss (above 5)");
  EXPECT_EQ(conditions[3].label, "method b: twice");
  const Table table = study.rows({.id = "t"}, {results, none, "toy"});
  EXPECT_EQ(table.columns,
            (std::vector<std::string>{"loss (above 5)", "twice"}));
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0].label, "method a");
  EXPECT_EQ(table.rows[1].cells[0].ours, 9);
  EXPECT_EQ(table.rows[1].cells[1].ours, 18);
}

}  // namespace
}  // namespace physinv
