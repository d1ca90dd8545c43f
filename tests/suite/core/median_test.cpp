#include "suite/core/median.h"

#include <gtest/gtest.h>

#include <limits>

namespace physinv {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargest = std::numeric_limits<double>::max();

TEST(Median, MiddleOfOddAndEvenLists) {
  EXPECT_EQ(median({7}), 7);
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
  EXPECT_EQ(median({4, 1, 4, 4, 1, 1}), 2.5);
  EXPECT_EQ(median({0.1, 0.2}), 0.5 * (0.1 + 0.2));
}

TEST(Median, InfinitiesAndLargeValuesAreNumbers) {
  EXPECT_EQ(median({1, kInfinity, kInfinity}), kInfinity);
  EXPECT_EQ(median({1, kInfinity}), kInfinity);
  EXPECT_EQ(median({kLargest, kLargest}), kLargest);
}

TEST(Median, HighIsOneOfTheValues) {
  EXPECT_EQ(median_high({3, 1, 2}), 2);
  EXPECT_EQ(median_high({4, 1, 2, 3}), 3);
  EXPECT_EQ(median_high({1, kInfinity}), kInfinity);
}

}  // namespace
}  // namespace physinv
