// Every registered case of the smoke profile, two iterations each.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "suite/harness/keys.h"
#include "suite/store/json.h"
#include "suite/store/results_json.h"
#include "tests/support/registered.h"

namespace physinv::test {
namespace {

std::vector<Case> smoke_cases() {
  return registry().expand("smoke", {.iterations = 2});
}

/// JSON writes what is not finite as null, so neither may be there.
template <class Json>
void expect_finite(const Json& value, const std::string& path) {
  EXPECT_FALSE(value.is_null()) << path;
  if (value.is_number_float()) {
    EXPECT_TRUE(std::isfinite(value.template get<double>())) << path;
  }
  if (!value.is_structured()) return;
  for (const auto& [key, part] : value.items())
    expect_finite(part, path + "/" + key);
}

class CaseContract : public testing::TestWithParam<Case> {};

TEST_P(CaseContract, GivesARecordWithFiniteNumbers) {
  Case c = GetParam();
  const CaseData data = draw_data(c);
  c.info.keys = content_keys(c, data.hash, numerics_of_build);
  auto records = run(c);
  ASSERT_EQ(records.size(), c.method->chain.size());
  for (const StageRecord& r : records) {
    ASSERT_NE(r.stop, Stop::failed) << r.message;
    const nlohmann::json json = to_json(r);
    expect_finite(json, r.stage);
    const StageRecord back =
        stage_from_json(nlohmann::json::parse(json.dump()));
    EXPECT_EQ(back.case_name, r.case_name);
    EXPECT_EQ(back.key, r.key);
    EXPECT_EQ(back.iterations, r.iterations);
    EXPECT_EQ(back.counts, r.counts);
    EXPECT_EQ(to_json(back), json);
  }
  expect_finite(to_json(c.info), "case");
  for (StageRecord& r : records)  // as a campaign does
    r.run = {.profile = "smoke",
             .host = "host",
             .processor = "processor",
             .instruction_set = "set",
             .threads = 1,
             .jobs = 1};
  const CaseRecord whole{c.info, data, records};
  const auto results = results_json({whole}, {c.info.name}, {});
  ASSERT_EQ(results.at("benchmarks").size(), records.size());
  for (const auto& entry : results.at("benchmarks"))
    expect_finite(entry, "results");
}

INSTANTIATE_TEST_SUITE_P(Smoke,
                         CaseContract,
                         testing::ValuesIn(smoke_cases()),
                         [](const testing::TestParamInfo<Case>& at) {
                           return test_name(at.param.info.name);
                         });

}  // namespace
}  // namespace physinv::test
