#include "suite/evidence/method_table.h"

#include <gtest/gtest.h>

#include "suite/evidence/study_table.h"
#include "suite/results/published.h"
#include "tests/suite/evidence/campaigns.h"

namespace physinv {
namespace {

RunValue loss() {
  return [](const Run& run) { return std::optional(run.stage->loss[0]); };
}

TEST(MethodTable, HasARowForEachMethodThatWasRun) {
  const Results results({case_of("a", 1, 0, {"fit"}, {stage_of("fit", {2})}),
                         case_of("a", 1, 1, {"fit"}, {stage_of("fit", {4})}),
                         case_of("b", 1, 0, {"fit"}, {stage_of("fit", {9})})});
  const Published none;
  const Table table = table_by_method(
      {.id = "t"},
      {results, none, "toy"},
      {{"b", "B"}, {"c", "C"}, {"a", "A"}},
      {median_column("middle", loss()),
       quantity_column("least",
                       [](const Select& s) { return lowest(s, loss()); }),
       {"who", [](const Evidence&, const Select& s) {
          return Cell{.text = s.method};
        }}});
  EXPECT_EQ(table.columns,
            (std::vector<std::string>{"middle", "least", "who"}));
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0].label, "B");
  EXPECT_EQ(table.rows[1].label, "A");
  EXPECT_EQ(table.rows[1].cells[0].ours, 3);
  EXPECT_EQ(table.rows[1].cells[1].text, "2");
  EXPECT_EQ(table.rows[1].cells[2].text, "a");
}

TEST(StudyTable, AsksEveryColumnOfEverySetting) {
  const Results results({case_of("a", 1, 0, {"fit"}, {stage_of("fit", {2})}),
                         case_of("b", 1, 0, {"fit"}, {stage_of("fit", {9})})});
  const Published none;
  const StudyTable<std::string> study{
      .settings = {"a", "b"},
      .columns = {{"loss (above 5)",
                   [](const std::string& m) {
                     return lowest(Select{m}, loss());
                   },
                   asks_above(5)},
                  {"twice",
                   [](const std::string& m) {
                     return times(2, lowest(Select{m}, loss()));
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
