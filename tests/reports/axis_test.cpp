#include "reports/axis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace physinv {
namespace {

std::string labels(const Axis& axis, int wanted) {
  std::string out;
  for (const Tick& t : axis.ticks(wanted)) out += t.label + " ";
  return out;
}

Axis axis_of(std::initializer_list<double> values, bool log) {
  Axis axis(log);
  for (const double v : values) axis.include(v);
  axis.finish();
  return axis;
}

TEST(Axis, LinearTicksAreRound) {
  EXPECT_EQ(labels(axis_of({0, 1}, false), 5), "0 0.2 0.4 0.6 0.8 1.0 ");
  EXPECT_EQ(labels(axis_of({-3, 11}, false), 4), "0 5 10 ");
  EXPECT_EQ(labels(axis_of({-1, 1}, false), 4), "−1.0 −0.5 0 0.5 1.0 ");
  EXPECT_EQ(labels(axis_of({0, 1}, false), 4), "0 0.25 0.50 0.75 1.00 ");
  EXPECT_EQ(labels(axis_of({0, 3e-6}, false), 3), "0 10⁻⁶ 2·10⁻⁶ 3·10⁻⁶ ");
}

TEST(Axis, LogTicksAreDecades) {
  EXPECT_EQ(labels(axis_of({0.01, 100}, true), 5), "0.01 0.1 1 10 100 ");
  EXPECT_EQ(labels(axis_of({1e-12, 1}, true), 4), "10⁻¹² 10⁻⁸ 10⁻⁴ 10⁰ ");
  EXPECT_EQ(labels(axis_of({3, 30}, true), 4), "5 10 20 ");
}

TEST(Axis, PowersOfTwoAreMarkedAsSuch) {
  EXPECT_EQ(labels(axis_of({2, 8, 128}, true), 6), "2 4 8 16 32 64 128 ");
  EXPECT_EQ(labels(axis_of({4}, true), 6), "4 ");
}

TEST(Axis, PlacesAndLimits) {
  Axis axis(true);
  axis.include(1);
  axis.include(100);
  axis.finish_tight();
  EXPECT_DOUBLE_EQ(axis.place(10), 0.5);
  EXPECT_EQ(axis.place(1e300), 3);
  EXPECT_FALSE(axis.shows(0));
  EXPECT_FALSE(axis.shows(-1));
  EXPECT_FALSE(axis.shows(std::numeric_limits<double>::infinity()));
}

TEST(Axis, DegenerateRangesStillWork) {
  for (const bool log : {false, true}) {
    for (const double v : {0.0, 1.0, 1e-300, 1e300}) {
      const Axis axis = axis_of({v}, log);
      EXPECT_LT(axis.lo(), axis.hi());
      EXPECT_LT(axis.ticks(5).size(), 45U);
    }
    EXPECT_LT(axis_of({}, log).lo(), axis_of({}, log).hi());
  }
  EXPECT_LT(axis_of({1e-300, 1e300}, true).ticks(5).size(), 8U);
  EXPECT_LT(axis_of({-1e308, 1e308}, false).ticks(5).size(), 45U);
}

}  // namespace
}  // namespace physinv
