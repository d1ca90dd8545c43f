#include "suite/evidence/run_values.h"

#include <gtest/gtest.h>

#include "suite/evidence/statistics.h"
#include "suite/evidence/training.h"
#include "suite/results/published.h"
#include "tests/suite/evidence/campaigns.h"

namespace physinv {
namespace {

TEST(RunValues, RowsHaveANumberOfEachExample) {
  StageRecord stage = stage_of("fit", {2, 4, 9});
  stage.example_iterations = losses({7, 5, 6});
  stage.example_evaluations = losses({8, 9, 10});
  const CaseRecord record = case_of("a", 3, 0, {"fit"}, {stage});
  const physinv::Run run{nullptr, &record, &record.stages.front()};
  EXPECT_EQ(losses()(run), (std::vector<double>{2, 4, 9}));
  EXPECT_EQ(iterations()(run), (std::vector<double>{7, 5, 6}));
  EXPECT_EQ(evaluations()(run), (std::vector<double>{8, 9, 10}));
  EXPECT_EQ(of_row(losses(), mean_of)(run), 5);
  EXPECT_EQ(of_row(losses(), least_of)(run), 2);
  EXPECT_EQ(of_row(iterations(), most_of)(run), 7);
  EXPECT_EQ(of_row(losses(), median)(run), 4);
}

TEST(RunValues, NoExamplesHaveNoStatistic) {
  const CaseRecord record = case_of("a", 0, 0, {"fit"}, {stage_of("fit", {})});
  const physinv::Run run{nullptr, &record, &record.stages.front()};
  EXPECT_FALSE(of_row(losses(), mean_of)(run));
}

TEST(RunValues, MediansAreOverAllRuns) {
  std::vector<CaseRecord> cases;
  for (std::uint64_t seed = 0; seed < 3; ++seed)
    cases.push_back(trained_case("a", seed, {9.0, 4.0 + double(seed), 1.0}));
  const Results results(std::move(cases));
  const Published none;
  const Evidence e{results, none, "toy"};
  EXPECT_DOUBLE_EQ(*median_after({"a"}, 10)(e).value, 5);
  EXPECT_DOUBLE_EQ(*median_at_end({"a"})(e).value, 1);
  EXPECT_DOUBLE_EQ(*lowest_at_end({"a"})(e).value, 1);
}

}  // namespace
}  // namespace physinv
