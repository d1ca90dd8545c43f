#include "suite/results/crowded.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "suite/results/exports.h"

namespace physinv {
namespace {

StageRecord of(Seconds solve, bool crowded = false) {
  StageRecord s;
  s.clocks.solve = solve;
  s.crowded = crowded;
  return s;
}

TEST(Crowded, IsWhoWaitsForACore) {
  EXPECT_FALSE(shared_its_core({1, 1}));
  EXPECT_FALSE(shared_its_core({1.2, 1}));
  EXPECT_TRUE(shared_its_core({1.3, 1}));
  EXPECT_TRUE(shared_its_core({7.3, 0.1}));
  EXPECT_FALSE(shared_its_core({1, 1.9})) << "two threads";
  EXPECT_FALSE(shared_its_core({}));
}

TEST(Crowded, OfAShortStageTheResolutionCounts) {
  EXPECT_FALSE(shared_its_core({9e-5, 1e-5}));
  EXPECT_FALSE(shared_its_core({4e-4, 3.1e-4}));
  EXPECT_TRUE(shared_its_core({3e-3, 1e-5})) << "others had a time slice";
}

TEST(Crowded, OneThreadTellsItsCpuTime) {
  EXPECT_EQ(seconds_to_tell(of({1, 0.99})), 0.99);
  EXPECT_EQ(seconds_to_tell(of({20, 1.5}, true)), 1.5);
  EXPECT_EQ(seconds_to_tell(of({1, 1 + 1e-7}, true)), 1) << "clocks are read "
                                                            "in turn";
}

TEST(Crowded, SeveralThreadsTellWallTimeUnlessCrowded) {
  EXPECT_EQ(seconds_to_tell(of({1, 1.9})), 1);
  EXPECT_FALSE(seconds_to_tell(of({1, 1.9}, true)));
}

TEST(Crowded, ChangedThreadsTellCpuTime) {
  StageRecord changed = of({1, 1.9}, true);
  changed.run.thread_changes = "2 from iteration 340";
  EXPECT_EQ(seconds_to_tell(changed), 1.9);
  EXPECT_TRUE(is_crowded(changed));
}

TEST(Crowded, StagesAreCounted) {
  std::vector<CaseRecord> cases(2);
  cases[0].stages = {of({1, 1}), of({2, 1}, true)};
  cases[1].stages = {of({1, 1})};
  EXPECT_EQ(crowded_text(cases).find("1 of 3 stages were crowded"), 0U);
  cases[0].stages.pop_back();
  EXPECT_EQ(crowded_text(cases), "");
}

nlohmann::ordered_json one_stage(bool crowded, double loss) {
  return {{"benchmarks",
           {{{"name", "a"},
             {"iterations", 1},
             {"real_time", 2.0},
             {"cpu_time", 1.0},
             {"time_unit", "ns"},
             {"loss_median",
              std::isfinite(loss) ? nlohmann::ordered_json(loss)
                                  : nlohmann::ordered_json()},
             {"forward", 1},
             {"vjp", 0},
             {"jacobian", 0},
             {"inverse", 0},
             {"physinv",
              {{"crowded", crowded},
               {"times", {{"wall", {2.0}}, {"cpu", {1.0}}}}}}}}}};
}

TEST(Exports, ALossThatIsNotFiniteIsAnError) {
  for (const bool finite : {true, false}) {
    const auto results = one_stage(false, finite ? 0.5 : NAN);
    EXPECT_EQ(bencher_metrics(results)["a"]["error"]["value"], finite ? 0 : 1);
    EXPECT_EQ(bencher_metrics(results)["a"].contains("loss"), finite);
    EXPECT_EQ(smaller_is_better(results)[0]["value"], finite ? 0 : 1);
    EXPECT_EQ(smaller_is_better(results)[0].contains("extra"), !finite);
  }
}

TEST(Crowded, ExportsSayIt) {
  for (const bool crowded : {true, false}) {
    const auto results = one_stage(crowded, 0.5);
    const auto said = [&](const std::string& text) {
      return text.find("crowded") != std::string::npos;
    };
    EXPECT_EQ(said(benchmark_csv(results)), crowded);
    EXPECT_EQ(said(smaller_is_better(results).dump()), crowded);
    EXPECT_EQ(bencher_metrics(results)["a"]["crowded"]["value"],
              crowded ? 1 : 0);
  }
}

}  // namespace
}  // namespace physinv
