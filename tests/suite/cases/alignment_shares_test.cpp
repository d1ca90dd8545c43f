#include <gtest/gtest.h>

#include "suite/cases/jpo/gradient_alignment/shares.h"
#include "suite/evidence/runs.h"
#include "suite/results/published.h"
#include "tests/suite/evidence/campaigns.h"

namespace physinv::alignment {
namespace {

/// Shares of 0.5, all of them at `sizes`, of the votes at all but the last.
Results measured(const std::vector<Index>& sizes, bool every_vote) {
  std::vector<CaseRecord> cases;
  for (const Index n : sizes) {
    auto stage = stage_of("measure", {1});
    const auto half = Batch<double>::Constant(1, 4, 0.5);
    stage.arrays["sum"] = half;
    if (every_vote || n != sizes.back()) stage.arrays["vote"] = half;
    auto c = case_of("known", n, 0, {"measure"}, {stage});
    c.info.experiment = kName;
    cases.push_back(std::move(c));
  }
  return Results(std::move(cases));
}

TEST(AlignmentShares, AreThereIfAllIsMeasuredAtTheSameSizes) {
  const Published published;
  const auto has = [&](const Results& results, const char* method) {
    return Fig2(Evidence{results, published, kName}).has(method);
  };
  EXPECT_TRUE(has(measured({1, 2, 4}, true), "known"));
  EXPECT_FALSE(has(measured({1, 2, 4}, false), "known"));
  EXPECT_FALSE(has(measured({1}, false), "known"));
  EXPECT_FALSE(has(measured({1, 2}, true), "sine"));
  EXPECT_FALSE(has(Results(), "linear"));
}

}  // namespace
}  // namespace physinv::alignment
