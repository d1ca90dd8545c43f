#include "suite/evidence/cell.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace physinv {
namespace {

TEST(Cell, WhatIsMissingSaysWhy) {
  EXPECT_EQ(cell_of(std::optional<double>{}).text, "not run");
  EXPECT_EQ(cell_of(std::vector<double>{}, kCrowded).text, "crowded");
  EXPECT_EQ(written(std::optional<double>{}, "{}", kNothing).text, "–");
  EXPECT_EQ(written(missing("too short")).text, "not run");
}

TEST(Cell, ANumberIsANumber) {
  EXPECT_EQ(cell_of(3.0).ours, 3);
  EXPECT_EQ(cell_of(3.0).text, "");
  const Cell mean = cell_of(std::vector<double>{1, 3});
  EXPECT_EQ(mean.ours, 2);
  EXPECT_NEAR(*mean.spread, 1.4142, 1e-4);
  EXPECT_FALSE(cell_of(std::vector<double>{1}).spread);
}

TEST(Cell, Words) {
  EXPECT_EQ(written(1234.5).text, "1.23e+03");
  EXPECT_EQ(written(1234.5, "{:.1f}").text, "1234.5");
  EXPECT_EQ(written(std::numeric_limits<double>::infinity()).text,
            "not finite");
}

}  // namespace
}  // namespace physinv
