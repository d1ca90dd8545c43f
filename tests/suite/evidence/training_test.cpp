// Numbers of one training run, from hand-made curves.
#include "suite/evidence/training.h"

#include <gtest/gtest.h>

#include <vector>

#include "suite/evidence/condition.h"
#include "suite/evidence/options.h"
#include "suite/evidence/run_values.h"
#include "suite/evidence/statistics.h"
#include "suite/results/published.h"
#include "suite/store/errors.h"
#include "tests/suite/evidence/campaigns.h"

namespace physinv {
namespace {

class TrainingTest : public testing::Test {
 protected:
  double value(const RunValue& of) const {
    return median({"a"}, of)(evidence_).value.value();
  }
  std::vector<std::optional<bool>> hold(
      const std::vector<Condition>& all) const {
    return each(all,
                [&](const Condition& c) { return c.judge(evidence_).holds; });
  }

  Results results_{{trained_case("a", 0, {4, 1, 3, 2}),
                    trained_case("b", 0, {4, 2, 3, 3}),
                    trained_case("c", 0, {4, 4, 4, 4}),
                    trained_case("c", 1, {4, 4, 4, 5}),
                    trained_case("d", 0, {4, 4, 4, 5}),
                    trained_case("d", 1, {4, 4, 4, 6})}};
  Published published_;
  Evidence evidence_{results_, published_, "toy"};
};

TEST_F(TrainingTest, PointsOfACurveAreItsEndsAndExtremes) {
  EXPECT_EQ(value(first_of()), 4);
  EXPECT_EQ(value(last_of()), 2);
  EXPECT_EQ(value(lowest_of()), 1);
  EXPECT_EQ(value(highest_of()), 4);
  EXPECT_EQ(value(lowest_of(metric(0))), 1);
  EXPECT_EQ(value(last_of(metric(0))), 4);
}

TEST_F(TrainingTest, ARiseIsOverTheLowestSoFar) {
  EXPECT_EQ(value(largest_rise()), 3);
  EXPECT_EQ(value(share_left()), 0.5);
  EXPECT_EQ(value(share_left(metric(0))), 0.25);
}

TEST_F(TrainingTest, AnArrayThatIsNotThereIsNoNumber) {
  EXPECT_EQ(value(late_training_error()), 7);
  const auto none =
      of_array(ArrayKey::own("none"), [](const Batch<double>&) { return 1.0; });
  EXPECT_EQ(median({"a"}, none)(evidence_).missing,
            "a too short, or without this value");
}

TEST_F(TrainingTest, SeveralMethodsGiveAListOfQuantities) {
  const std::vector<Select> runs = {{"a"}, {"b"}, {"c"}};
  EXPECT_EQ(most(medians(runs, last_of()))(evidence_).value, 4.5);
  EXPECT_EQ(most(lowests(runs, last_of()))(evidence_).value, 4);
  EXPECT_EQ(spread_ratio(medians(runs, last_of()))(evidence_).value, 2.25);
  EXPECT_EQ(each(runs, [](const Select& s) { return s.method; }),
            (std::vector<std::string>{"a", "b", "c"}));
}

TEST_F(TrainingTest, OneSeedIsBelowAndNotEnough) {
  const std::optional<bool> yes = true, no = false, open;
  const auto below = [&](const char* one, const char* other) {
    return hold(below_on_every_seed("end", {one}, {other}, last_of()));
  };
  EXPECT_EQ(below("a", "b"), (std::vector{yes, open}));
  EXPECT_EQ(below("b", "a"), (std::vector{no, open}));
  EXPECT_EQ(below("c", "d"), (std::vector{yes, yes}));
  EXPECT_EQ(below("d", "c"), (std::vector{no, no}));
}

TEST_F(TrainingTest, OptionsAreNumbersOrAreRefused) {
  const Options& options = results_.cases().front().stages.front().options;
  EXPECT_EQ(number_of(options, "batch"), 64);
  EXPECT_EQ(number_of(options, "rate"), 1e-3);
  EXPECT_FALSE(number_of(options, "tau"));
  try {
    number_of(options, "rule");
    FAIL();
  } catch (const UnreadableInput& e) {
    EXPECT_STREQ(e.what(),
                 "option 'rule' of a stage is 'adam'; expected a number");
  }
}

}  // namespace
}  // namespace physinv
