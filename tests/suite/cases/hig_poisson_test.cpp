// What the Poisson experiment's claims read out of curves and chains.
#include <gtest/gtest.h>

#include <cmath>

#include "suite/evidence/curve.h"
#include "tests/suite/cases/hig_fixture.h"

namespace physinv {
namespace hig::poisson {
void add_claims(Registry&);
}
namespace {

constexpr const char* kName = "hig/poisson";

ClaimResult claim(const std::vector<CaseRecord>& cases, const char* id) {
  return judged(hig::poisson::add_claims, kName, cases, id);
}

TEST(HigPoisson, LevelsLieBetweenMeasuredPoints) {
  const StageRecord s = trained("adam", {100, 10, 1});
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
  StageRecord s = trained("adam", {100, 10});
  s.stop = Stop::diverged;
  EXPECT_TRUE(std::isinf(level_at(&s, 50)->loss));
}

TEST(HigPoisson, NothingRunIsNotJudged) {
  const auto other = chain(kName, "gn-b4", {trained("hig", {2, 1})});
  for (const char* id : {"A1",
                         "A2",
                         "A3",
                         "A4",
                         "A5",
                         "A6",
                         "A7",
                         "A8",
                         "A8b",
                         "A9",
                         "P1",
                         "P2",
                         "P3",
                         "P4",
                         "P5",
                         "P6",
                         "P7",
                         "P8",
                         "P9"})
    EXPECT_EQ(claim({other}, id).verdict, Verdict::not_judged) << id;
  EXPECT_FALSE(claim({}, "A7").gates);
}

TEST(HigPoisson, AdamReturnsOrDoesNot) {
  const auto verdict = [](double later) {
    // Twenty-one points reach 200 updates.
    std::vector<double> again(21, later);
    again[0] = 30;
    return claim({chain(kName,
                        "adam-hig-adam",
                        {trained("adam", {100, 20}),
                         trained("hig", {20, 30}),
                         trained("again", again)})},
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
    return claim({chain(kName, "hig-002-b16", {trained("hig", hig)}),
                  chain(kName, "adam", {trained("adam", adam)})},
                 "A3")
        .verdict;
  };
  EXPECT_EQ(verdict(60), Verdict::reproduced);
  EXPECT_EQ(verdict(45), Verdict::not_reproduced);
}

TEST(HigPoisson, DroppedSingularValuesAreSeen) {
  const auto verdict = [](double kept, const char* method, const char* id) {
    StageRecord s = trained("hig", {20, 10});
    s.options = {{"batch", "2"}};
    s.arrays["kept"] = Batch<double>::Constant(1, 3, 128);
    s.arrays["kept"](1) = kept;
    s.arrays["path"] = Batch<double>::Constant(1, 3, 1);
    s.arrays["smallest"] = Batch<double>::Constant(1, 3, 1e-3);
    s.arrays["unproven"] = Batch<double>::Zero(1, 1);
    return claim({chain(kName, method, {s})}, id).verdict;
  };
  EXPECT_EQ(verdict(128, "hig-b4", "A8b"), Verdict::reproduced);
  EXPECT_EQ(verdict(127, "hig-b4", "A8b"), Verdict::not_reproduced);
  EXPECT_EQ(verdict(128, "long-adam-hig", "A8"), Verdict::reproduced);
  EXPECT_EQ(verdict(127, "long-adam-hig", "A8"), Verdict::not_reproduced);
  EXPECT_EQ(verdict(127, "hig-b4", "A8"), Verdict::not_judged);
}

/// A loss that falls by a power of the updates, every ten of them up to 160.
std::vector<double> power_law(double exponent) {
  std::vector<double> loss = {100};
  for (int k = 1; k <= 16; ++k) loss.push_back(10 * std::pow(k, -exponent));
  return loss;
}

TEST(HigPoisson, SlopesAreOctavesOfTheLossPerOctaveOfUpdates) {
  const auto adam = [](const char* method, double exponent) {
    return chain(kName, method, {trained("adam", power_law(exponent))});
  };
  const auto claims = [&](double large) {
    return claim(
        {adam("adam", 2), adam("adam-3e-4", 1), adam("adam-1e-3", large)},
        "P2");
  };
  EXPECT_NEAR(*claims(0.5).conditions[0].value, 0.5, 1e-12);
  EXPECT_NEAR(*claims(0.5).conditions[1].value, 0.25, 1e-12);
  EXPECT_EQ(claims(0.5).verdict, Verdict::reproduced);
  EXPECT_EQ(claims(2.5).verdict, Verdict::not_reproduced);
}

TEST(HigPoisson, ALeadIsAShareOfUpdatesBelowEveryOther) {
  const auto hig = [](const char* method) {
    return chain(kName, method, {trained("hig", {100, 10, 10, 10, 10})});
  };
  const auto adam = [](const char* method, double level) {
    return chain(
        kName, method, {trained("adam", {100, 90, level, level, level})});
  };
  const auto share = [&](double level) {
    return *claim({hig("hig-001-b64"),
                   hig("hig-002-b64"),
                   hig("hig-005-b64"),
                   adam("adam", 80),
                   adam("adam-3e-4", 70),
                   adam("adam-1e-3", level)},
                  "P5")
                .conditions[0]
                .value;
  };
  EXPECT_EQ(share(20), 1);
  EXPECT_EQ(share(10), 19.0 / 40);
}

TEST(HigPoisson, OnlyWhatHigGainedCanBeLost) {
  const auto lost = [](double hig_end, double after) {
    std::vector<double> again(260, after);
    return claim({chain(kName,
                        "long-adam-hig-adam",
                        {trained("adam", {100, 20}),
                         trained("hig", {20, hig_end}),
                         trained("again", again)})},
                 "P9")
        .verdict;
  };
  EXPECT_EQ(lost(10, 19), Verdict::reproduced);
  EXPECT_EQ(lost(10, 9), Verdict::not_reproduced);
  EXPECT_EQ(lost(19, 19), Verdict::not_reproduced);  // nothing to lose
}

}  // namespace
}  // namespace physinv
