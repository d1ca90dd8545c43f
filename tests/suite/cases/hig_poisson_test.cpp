// What the Poisson experiment reads out of curves and chains.
#include <gtest/gtest.h>

#include <cmath>

#include "suite/cases/hig/poisson/claims.h"

namespace physinv::poisson {
namespace {

StageRecord stage(const std::string& name, const std::vector<double>& loss) {
  StageRecord s;
  s.stage = name;
  for (std::size_t k = 0; k < loss.size(); ++k) {
    s.curve.iteration.push_back(10.0 * static_cast<double>(k));
    s.curve.seconds.push_back(static_cast<double>(k));
  }
  s.arrays["mean_loss"] = Eigen::Map<const Batch<double>>(
      loss.data(), 1, static_cast<Index>(loss.size()));
  s.iterations = 10 * (static_cast<Index>(loss.size()) - 1);
  return s;
}

CaseRecord chain(const std::string& method,
                 std::uint64_t seed,
                 std::vector<StageRecord> stages) {
  CaseRecord c;
  c.info.experiment = kName;
  c.info.method = method;
  c.info.n = 4;
  c.info.seed = seed;
  for (const auto& s : stages) c.info.stages.push_back(s.stage);
  c.stages = std::move(stages);
  return c;
}

ClaimResult claim(const std::vector<CaseRecord>& cases, const char* id) {
  const Results results(cases);
  for (const ClaimResult& c : claims(Runs(results)))
    if (c.id == id) return c;
  return {};
}

TEST(HigPoisson, LevelsLieBetweenMeasuredPoints) {
  const StageRecord s = stage("adam", {100, 10, 1});
  EXPECT_EQ(level_at(&s, 10)->loss, 10);
  EXPECT_NEAR(level_at(&s, 15)->loss, std::sqrt(10), 1e-12);
  EXPECT_NEAR(level_at(&s, 15)->seconds, 1.5, 1e-12);
  EXPECT_FALSE(level_at(&s, 21));
  EXPECT_FALSE(level_at(nullptr, 0));
  EXPECT_NEAR(reaches(&s, std::sqrt(10))->updates, 15, 1e-9);
  EXPECT_EQ(reaches(&s, 200)->updates, 0);
  EXPECT_FALSE(reaches(&s, 0.5));
}

TEST(HigPoisson, ADivergedRunIsInfiniteFromThereOn) {
  StageRecord s = stage("adam", {100, 10});
  s.stop = Stop::diverged;
  EXPECT_TRUE(std::isinf(level_at(&s, 50)->loss));
}

TEST(HigPoisson, NothingRunIsNotRun) {
  for (const char* id : {"A1", "A2", "A3", "A4", "A5", "A6", "A7", "A8", "A9"})
    EXPECT_EQ(claim({}, id).verdict, Verdict::not_judged) << id;
  EXPECT_FALSE(claim({}, "A7").gates);
}

TEST(HigPoisson, AdamReturnsOrDoesNot) {
  const auto verdict = [](double later) {
    // Twenty-one points reach 200 updates.
    std::vector<double> again(21, later);
    again[0] = 30;
    return claim({chain("adam-hig-adam",
                        0,
                        {stage("adam", {100, 20}),
                         stage("hig", {20, 30}),
                         stage("again", again)})},
                 "A6")
        .verdict;
  };
  EXPECT_EQ(verdict(20.5), Verdict::reproduced);
  EXPECT_EQ(verdict(22), Verdict::not_reproduced);
}

TEST(HigPoisson, AdamsUpdatesAreCountedToTheSameLevel) {
  const auto verdict = [](double late) {
    std::vector<double> hig = {200, 180, 160, 140, 120, 100, 50};
    std::vector<double> adam(41, 100.0);
    for (std::size_t k = 30; k < adam.size(); ++k) adam[k] = late;
    for (std::size_t k = 38; k < adam.size(); ++k) adam[k] = 40;
    return claim({chain("hig-002-b16", 0, {stage("hig", hig)}),
                  chain("adam", 0, {stage("adam", adam)})},
                 "A3")
        .verdict;
  };
  EXPECT_EQ(verdict(60), Verdict::reproduced);
  EXPECT_EQ(verdict(45), Verdict::not_reproduced);
}

TEST(HigPoisson, DroppedSingularValuesAreSeen) {
  const auto verdict = [](double kept) {
    StageRecord s = stage("hig", {20, 10});
    s.options = {{"batch", "2"}};
    s.arrays["kept"] = Batch<double>::Constant(1, 3, 128);
    s.arrays["kept"](1) = kept;
    s.arrays["path"] = Batch<double>::Constant(1, 3, 1);
    s.arrays["smallest"] = Batch<double>::Constant(1, 3, 1e-3);
    s.arrays["unproven"] = Batch<double>::Zero(1, 1);
    return claim({chain("hig-b4", 0, {s})}, "A8").verdict;
  };
  EXPECT_EQ(verdict(128), Verdict::reproduced);
  EXPECT_EQ(verdict(127), Verdict::not_reproduced);
}

}  // namespace
}  // namespace physinv::poisson
