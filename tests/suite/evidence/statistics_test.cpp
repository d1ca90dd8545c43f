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

}  // namespace
}  // namespace physinv
