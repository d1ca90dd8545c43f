#include "suite/evidence/method_table.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace physinv
