// What the quantum dipole's claims read out of curves of the loss and of the
// two levels.
#include <gtest/gtest.h>

#include "tests/suite/cases/hig_fixture.h"

namespace physinv {
namespace dipole {
void add_claims(Registry&);
}
namespace {

constexpr const char* kDipole = "hig/quantum-dipole";

CaseRecord levels(const char* method,
                  const std::vector<double>& low,
                  const std::vector<double>& high,
                  std::uint64_t seed = 0) {
  StageRecord s = trained("train", low);
  const auto points = static_cast<Index>(low.size());
  s.arrays["metrics"].resize(2, points);
  s.arrays["metrics"].row(0) =
      Eigen::Map<const Batch<double>>(low.data(), 1, points);
  s.arrays["metrics"].row(1) =
      Eigen::Map<const Batch<double>>(high.data(), 1, points);
  return chain(kDipole, method, {s}, seed);
}

TEST(HigQuantumDipole, LagAndRiseOfTheLevels) {
  const auto a4 = [](const std::vector<double>& low,
                     const std::vector<double>& high) {
    return judged(
        dipole::add_claims, kDipole, {levels("hig", low, high)}, "A4");
  };
  // HE < 0.1 at 20 updates, LE at 10, with a rise of 0.02 between; what comes
  // behind does not count.
  const auto apart = a4({0.5, 0.05, 0.07, 0.9}, {0.5, 0.3, 0.05, 0.01});
  EXPECT_DOUBLE_EQ(*apart.conditions[0].value, 2);
  EXPECT_NEAR(*apart.conditions[1].value, 0.02, 1e-12);
  EXPECT_EQ(apart.verdict, Verdict::not_reproduced);
  const auto together = a4({0.5, 0.05, 0.07, 0.9}, {0.5, 0.05, 0.01, 0.01});
  EXPECT_DOUBLE_EQ(*together.conditions[0].value, 1);
  EXPECT_EQ(*together.conditions[1].value, 0);
  EXPECT_EQ(together.verdict, Verdict::reproduced);
  // Never below: not a number.
  EXPECT_EQ(a4({0.5, 0.05}, {0.5, 0.3}).verdict, Verdict::not_judged);
}

TEST(HigQuantumDipole, TheRatioOfTheRiseWaitsForTheFirstLevel) {
  std::vector<double> low(801, 0.01), high(801, 0.01);
  low[0] = 0.2, low[1] = 0.6, low[2] = 0.05, low[3] = 0.1, low[4] = 0.01;
  high[0] = high[1] = high[2] = high[3] = 0.4;
  const auto p7 =
      judged(dipole::add_claims, kDipole, {levels("adam", low, high)}, "P7");
  EXPECT_DOUBLE_EQ(*p7.conditions[0].value, 2);
  EXPECT_DOUBLE_EQ(*p7.conditions[1].value, 2);
  low.resize(800), high.resize(800);
  EXPECT_EQ(
      judged(dipole::add_claims, kDipole, {levels("adam", low, high)}, "P7")
          .verdict,
      Verdict::not_judged);
}

TEST(HigQuantumDipole, FourOfFiveSeedsDecide) {
  const auto a1 = [](std::vector<double> levels) {
    std::vector<CaseRecord> cases;
    for (std::size_t seed = 0; seed < levels.size(); ++seed)
      cases.push_back(
          chain(kDipole,
                "hig",
                {trained("train", std::vector<double>(20, levels[seed]))},
                seed));
    return judged(dipole::add_claims, kDipole, cases, "A1").verdict;
  };
  EXPECT_EQ(a1({0.1, 0.1, 0.9, 0.1, 0.1}), Verdict::reproduced);
  EXPECT_EQ(a1({0.1, 0.1, 0.9, 0.9, 0.1}), Verdict::not_reproduced);
  EXPECT_EQ(a1({0.1, 0.9, 0.1}), Verdict::reproduced);
  EXPECT_EQ(a1({0.1, 0.9, 0.9}), Verdict::not_reproduced);
}

TEST(HigQuantumDipole, TheLongestStretchNearOneHalfIsTaken) {
  std::vector<double> loss(301, 0.1);
  for (int k = 0; k < 60; ++k) loss[5 + k] = 0.5;
  for (int k = 0; k < 120; ++k) loss[100 + k] = 0.45;
  const auto a3 = judged(dipole::add_claims,
                         kDipole,
                         {chain(kDipole, "adam", {trained("train", loss)}),
                          chain(kDipole, "hig", {trained("train", {1, 0.1})})},
                         "A3");
  EXPECT_DOUBLE_EQ(*a3.conditions[0].value, 1190);
  EXPECT_EQ(a3.verdict, Verdict::reproduced);
}

}  // namespace
}  // namespace physinv
