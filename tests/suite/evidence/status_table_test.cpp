#include "suite/evidence/status_table.h"

#include <gtest/gtest.h>

#include "tests/suite/evidence/campaigns.h"

namespace physinv {
namespace {

using Steps = std::vector<double>;

StageRecord solved(const std::string& stage,
                   std::vector<Status> statuses,
                   const Steps& steps) {
  StageRecord s = stage_of(stage, Steps(steps.size(), 1.0));
  s.status = std::move(statuses);
  s.arrays["first_step"] = losses(steps).transpose();
  return s;
}

Table table_of(std::vector<CaseRecord> cases) {
  return status_table(Results(std::move(cases)), "toy", {{"m", "Method"}});
}

std::vector<double> numbers(const TableRow& row) {
  std::vector<double> all;
  for (const Cell& cell : row.cells) all.push_back(*cell.ours);
  return all;
}

TEST(StatusTable, CountsEndsOverAllSizesAndSeeds) {
  using enum Status;
  auto failed = solved("solve", {gtol}, {1});
  failed.stop = Stop::failed;
  const Table table = table_of(
      {case_of("m", 2, 0, {"solve"}, {solved("solve", {gtol, ftol}, {1, 2})}),
       case_of("m", 1, 1, {"solve"}, {solved("solve", {linesearch}, {0})}),
       case_of("m", 1, 2, {"solve"}, {failed}),
       case_of("net",
               2,
               0,
               {"fit", "refine"},
               {stage_of("fit", {1, 1}),
                solved("refine", {gtol, nonfinite}, {0, 0})})});
  EXPECT_EQ(
      table.columns,
      (std::vector<std::string>{
          "problems", "gtol", "linesearch", "nonfinite", "ftol", "stayed"}));
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0].label, "Method");
  EXPECT_EQ(numbers(table.rows[0]), (std::vector<double>{3, 1, 1, 0, 1, 1}));
  EXPECT_EQ(table.rows[1].label, "net refine");
  EXPECT_EQ(numbers(table.rows[1]), (std::vector<double>{2, 1, 0, 1, 0, 2}));
}

TEST(StatusTable, IsLeftOutWhereThereIsNothingToCount) {
  using enum Status;
  EXPECT_TRUE(table_of({case_of("m", 1, 0, {"fit"}, {stage_of("fit", {1})})})
                  .rows.empty());
  const auto moved = solved("solve", {gtol, gtol}, {1, 2});
  EXPECT_TRUE(table_of({case_of("m", 2, 0, {"solve"}, {moved})}).rows.empty());
  const auto stays = solved("solve", {gtol, gtol}, {1, 0});
  EXPECT_EQ(table_of({case_of("m", 2, 0, {"solve"}, {stays})}).rows.size(), 1U);
}

}  // namespace
}  // namespace physinv
