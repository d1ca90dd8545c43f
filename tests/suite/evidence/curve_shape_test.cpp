#include "suite/evidence/curve_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "suite/evidence/statistics.h"
#include "suite/results/published.h"
#include "tests/suite/evidence/campaigns.h"

namespace physinv {
namespace {

/// Points after 0, 10, ... 40 updates.
CaseRecord diverged(CaseRecord c) {
  c.stages.back().stop = Stop::diverged;
  return c;
}

class CurveShapeTest : public testing::Test {
 protected:
  Measured of(const char* method, const RunValue& value) const {
    return median({method}, value)(evidence_);
  }

  Results results_{{trained_case("even", 0, {16, 8, 4, 2, 1}),
                    trained_case("flat", 0, {9, 3, 3, 3, 1}),
                    trained_case("short", 0, {9, 3}),
                    diverged(trained_case("lost", 0, {1, 2, 3, 4, 5})),
                    trained_case("many", 0, {1}),
                    trained_case("many", 1, {2}),
                    trained_case("many", 2, {3}),
                    trained_case("many", 3, {4}),
                    trained_case("many", 4, {5})}};
  Published published_;
  Evidence evidence_{results_, published_, "toy"};
};

TEST_F(CurveShapeTest, SteepnessIsInOctavesPerDoubling) {
  EXPECT_DOUBLE_EQ(*of("even", steepness()).value, 2);
  EXPECT_DOUBLE_EQ(*of("even", steepness(1)).value, 1);
  EXPECT_DOUBLE_EQ(*of("even", log_fall(updates(), 10, 30)).value, std::log(4));
}

TEST_F(CurveShapeTest, APlateauIsTheLongestStretchInARange) {
  EXPECT_EQ(of("flat", plateau(updates(), 2, 4)).value, 20);
  EXPECT_EQ(of("even", plateau(updates(), 20, 30)).value, 0);
}

TEST_F(CurveShapeTest, ScatterIsOfTheLastHalf) {
  EXPECT_DOUBLE_EQ(*of("even", scatter()).value, std::log(2));
  EXPECT_DOUBLE_EQ(*of("flat", scatter()).value, std::log(3) / 2);
  EXPECT_EQ(of("lost", scatter()).value, kInfinite);
  EXPECT_EQ(of("short", scatter()).missing,
            "short too short, or without this value");
}

TEST_F(CurveShapeTest, SettledIsTheMedianOfTheLastThreePoints) {
  EXPECT_EQ(of("even", settled_loss()).value, 2);
  EXPECT_EQ(of("short", settled_loss()).missing,
            "short too short, or without this value");
}

TEST_F(CurveShapeTest, ALeadIsAShareOfTheUpdates) {
  // "even" reaches 3, the level of "flat", after 24.15 of 40 updates.
  EXPECT_EQ(lead({"flat"}, {{"even"}})(evidence_).value, 24.0 / 40);
  EXPECT_EQ(lead({"flat"}, {{"even"}}).runs().size(), 2U);
  EXPECT_EQ(lead({"flat"}, {{"none"}})(evidence_).missing,
            "flat too short, or without this value");
}

TEST_F(CurveShapeTest, SeveralMethodsOfOneSeedSpread) {
  const auto after = loss_after(10);
  EXPECT_DOUBLE_EQ(
      *spread_of_seeds({{"even"}, {"flat"}}, after)(evidence_).value, 8.0 / 3);
}

TEST_F(CurveShapeTest, TheHighestAlongACurveBeginsAtAnUpdate) {
  const auto after = [](double u) { return median({"flat"}, loss_after(u)); };
  EXPECT_EQ(highest_along({"flat"}, 0, after)(evidence_).value, 9);
  EXPECT_EQ(highest_along({"flat"}, 10, after)(evidence_).value, 3);
  EXPECT_EQ(highest_along({"flat"}, 50, after)(evidence_).missing,
            "runs long enough");
  EXPECT_EQ(highest_along({"none"}, 0, after)(evidence_).missing,
            "none not run");
}

TEST_F(CurveShapeTest, FourOfFiveSeedsStayOnASide) {
  EXPECT_EQ(most_stay_below({"many"}, last_loss())(evidence_).value, 4);
  EXPECT_EQ(most_stay_above({"many"}, last_loss())(evidence_).value, 2);
  EXPECT_EQ(most_stay_above({"none"}, last_loss())(evidence_).missing,
            "none not run");
}

}  // namespace
}  // namespace physinv
