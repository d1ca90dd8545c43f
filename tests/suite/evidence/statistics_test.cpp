#include "suite/evidence/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace physinv {
namespace {

TEST(Statistics, QuantilesAreLinearBetweenValues) {
  EXPECT_EQ(quantile({0, 10, 20}, 0), 0);
  EXPECT_EQ(quantile({20, 0, 10}, 1), 20);
  EXPECT_DOUBLE_EQ(quantile({0, 10, 20}, 0.75), 15);
  EXPECT_EQ(quantile({1, kInfinite, kInfinite}, 0.75), kInfinite);
}

TEST(Statistics, OneValueHasNoDeviation) {
  EXPECT_FALSE(mean_std({}));
  EXPECT_FALSE(mean_std(std::vector{2.0})->std);
  const auto two = mean_std(std::vector{1.0, 3.0});
  EXPECT_EQ(two->mean, 2);
  EXPECT_DOUBLE_EQ(*two->std, std::sqrt(2.0));
}

TEST(Statistics, LineThroughPoints) {
  const std::vector<double> x = {0, 1, 2, 3};
  const auto exact = fit_line(x, std::vector<double>{1, 3, 5, 7});
  EXPECT_DOUBLE_EQ(exact->slope, 2);
  EXPECT_DOUBLE_EQ(exact->intercept, 1);
  EXPECT_NEAR(exact->slope_error, 0, 1e-15);
  // Residuals -0.1, 0.2, -0.1, ... : s = sqrt(sum r^2 / 2 / sum (x - mean)^2).
  const auto noisy = fit_line(x, std::vector<double>{0, 1.2, 1.8, 3});
  EXPECT_NEAR(noisy->slope, 0.96, 1e-12);
  EXPECT_NEAR(noisy->slope_error, std::sqrt(0.072 / 2 / 5), 1e-12);
  EXPECT_FALSE(fit_line(std::vector{0.0, 1.0}, std::vector{0.0, 1.0}));
}

TEST(Statistics, ToleranceIntervalsAreWilks) {
  // 93 values are the least whose extremes hold 95 % with confidence 0.95.
  std::vector<double> values;
  for (int i = 0; i < 92; ++i) values.push_back(i);
  EXPECT_FALSE(tolerance_interval(values, 0.95, 0.95));
  values.push_back(92);
  const auto all = tolerance_interval(values, 0.95, 0.95);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->lowest, 0);
  EXPECT_EQ(all->highest, 92);
  // 24 values: the extremes hold 80 % with confidence
  // 1 - 24 0.8^23 + 23 0.8^24 = 0.967, the second ones not 0.95.
  values.resize(24);
  const auto most = tolerance_interval(values, 0.8, 0.95);
  ASSERT_TRUE(most);
  EXPECT_EQ(most->lowest, 0);
  EXPECT_EQ(most->highest, 23);
  // Half of all runs are held by much less than the whole sample.
  EXPECT_GT(tolerance_interval(values, 0.5, 0.9)->lowest, 0);
}

}  // namespace
}  // namespace physinv
