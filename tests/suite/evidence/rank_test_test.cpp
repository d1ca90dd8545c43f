#include "suite/evidence/rank_test.h"

#include <gtest/gtest.h>

#include <limits>

namespace physinv {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

double p_of(const std::vector<double>& differences) {
  return signed_rank(differences).p;
}

/// Numbers of scipy.stats.wilcoxon 1.10.1.
TEST(SignedRank, IsScipysWhereAllSignsAreCounted) {
  // Heights of Darwin's maize.
  EXPECT_DOUBLE_EQ(
      p_of({6, 8, 14, 16, 23, 24, 28, 29, 41, -48, 49, 56, 60, -67, 75}),
      0.041259765625);
  EXPECT_DOUBLE_EQ(p_of({1, -2, 3, -4, 5}), 0.8125);
  EXPECT_DOUBLE_EQ(p_of({-1, -2, -3, -4, -5, -6}), 0.03125);
}

TEST(SignedRank, IsScipysByTheNormalDistribution) {
  std::vector<double> many, all_below, shared;
  for (int k = 0; k < 101; ++k) many.push_back(((k * 37) % 101 - 30) / 10.0);
  for (int k = 1; k <= 60; ++k) all_below.push_back(-k);
  for (int k = 0; k < 64; ++k) shared.push_back((k * 5) % 9 - 3);
  EXPECT_NEAR(p_of(many) / 3.0976549287952025e-08, 1, 1e-10);
  EXPECT_NEAR(p_of(all_below) / 1.6295557943119345e-11, 1, 1e-10);
  EXPECT_NEAR(p_of(shared) / 0.007309327414250738, 1, 1e-10);
}

TEST(SignedRank, SharedRanksAreCountedLikeAnyOther) {
  // Ranks 1.5, 1.5, 3, 4 of four: of 16 signs, 1 has a sum of 0 and 2 of 1.5.
  EXPECT_DOUBLE_EQ(p_of({1, -1, 2, 3}), 2.0 * 3 / 16);
  EXPECT_DOUBLE_EQ(p_of({1, 1, 2, 3, 0}), 2.0 * 1 / 16);
}

TEST(SignedRank, CountsPairs) {
  const SignedRank test = signed_rank(std::vector<double>{-1, -kInf, 2, 0});
  EXPECT_EQ(test.pairs, 4U);
  EXPECT_EQ(test.below, 2U);
  EXPECT_EQ(test.ties, 1U);
  EXPECT_EQ(p_of({}), 1);
  EXPECT_EQ(p_of({0, 0}), 1);
  EXPECT_EQ(p_of({1}), 1);
  EXPECT_EQ(p_of({-kInf, kInf}), 1);
}

TEST(DecadesAbove, SolvedAndNotFinite) {
  EXPECT_DOUBLE_EQ(decades_above(1e-3, 1e-5), 2);
  EXPECT_EQ(decades_above(1e-20, 0), 0) << "both are solved";
  EXPECT_DOUBLE_EQ(decades_above(1e-20, 1e-10), -2);
  EXPECT_EQ(decades_above(kInf, 1), kInf);
  EXPECT_EQ(decades_above(1, kInf), -kInf);
  EXPECT_EQ(decades_above(kInf, kInf), 0);
}

/// Numbers of R's p.adjust(c(0.01, 0.04, 0.03, 0.005), "holm").
TEST(Holm, IsRs) {
  const auto p = holm({0.01, 0.04, 0.03, 0.005});
  ASSERT_EQ(p.size(), 4U);
  EXPECT_DOUBLE_EQ(p[0], 0.03);
  EXPECT_DOUBLE_EQ(p[1], 0.06);
  EXPECT_DOUBLE_EQ(p[2], 0.06);
  EXPECT_DOUBLE_EQ(p[3], 0.02);
  EXPECT_EQ(holm({0.9, 0.8}), (std::vector<double>{1, 1}));
  EXPECT_TRUE(holm({}).empty());
}

TEST(PText, SaysHowSmall) {
  EXPECT_EQ(p_text(1e-9), "p < 1e-6");
  EXPECT_EQ(p_text(0.034), "p = 0.034");
  EXPECT_EQ(p_text(1), "p = 1");
}

}  // namespace
}  // namespace physinv
