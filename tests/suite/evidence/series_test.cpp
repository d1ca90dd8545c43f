#include "suite/evidence/series.h"

#include <gtest/gtest.h>

namespace physinv {
namespace {

TEST(Series, NumbersAreEquallySpacedFromEndToEnd) {
  EXPECT_EQ(spaced(-1, 1, 5), (std::vector<double>{-1, -0.5, 0, 0.5, 1}));
}

TEST(Series, AMarkIsAPointAndALevelALine) {
  const Series point =
                   mark("target", "truth", 1, 2, PlotStyle{.hue = Hue::ink}),
               line = level("solution", "truth", 1, 9, 3);
  EXPECT_EQ(point.x, std::vector<double>{1});
  EXPECT_EQ(point.y, std::vector<double>{2});
  EXPECT_TRUE(point.markers && !point.line && !point.dashed);
  EXPECT_EQ(point.style->hue, Hue::ink);
  EXPECT_EQ(line.x, (std::vector<double>{1, 9}));
  EXPECT_EQ(line.y, (std::vector<double>{3, 3}));
  EXPECT_TRUE(line.dashed && line.line && !line.markers);
}

}  // namespace
}  // namespace physinv
