#include "suite/evidence/cell.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "suite/results/published.h"
#include "suite/results/results.h"

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

TEST(Cell, AMeasuredNumberHasItsSpread) {
  const Cell cell = cell_of(Measured{.value = 3, .spread = 0.5, .runs = 2});
  EXPECT_EQ(cell.ours, 3);
  EXPECT_EQ(cell.spread, 0.5);
  EXPECT_EQ(cell_of(missing("three seeds")).text, "not run");
}

TEST(Cell, OfChangedThreadsTheCpuTimeIsTold) {
  StageRecord stage;
  stage.clocks.solve = {1, 1.9};
  stage.crowded = true;
  TimedStages times;
  EXPECT_FALSE(times.seconds(stage));
  stage.run.thread_changes = "2 from iteration 340";
  EXPECT_EQ(times.seconds(stage), 1.9);
  EXPECT_NE(times.note().find("1 of 2 stages shared their cores"),
            std::string::npos);
  EXPECT_NE(times.note().find("1 of 2 stages changed their number of threads"),
            std::string::npos);
}

TEST(Cell, StandsBesideWhatIsPrinted) {
  Published published;
  published.add(R"({"publication": {"key": "toy", "title": "Toy",
    "authors": ["A"], "year": 2022, "venue": "V"}, "values": [
    {"experiment": "toy", "quantity": "t/x", "value": 5, "spread": 2,
     "unit": "%", "where": "Table 3"}]})",
                "toy.json");
  const Results none;
  const Cell cell =
      beside_printed(cell_of(4.0), {none, published, "toy"}, "t/x");
  EXPECT_EQ(cell.ours, 4);
  EXPECT_EQ(cell.paper, 5);
  EXPECT_EQ(cell.paper_spread, 2);
  const Evidence elsewhere{none, published, "other"};
  EXPECT_FALSE(beside_printed({}, elsewhere, "t/x").paper);
  EXPECT_EQ(beside_printed({}, elsewhere, "toy t/x").paper, 5);
}

TEST(Cell, Words) {
  EXPECT_EQ(written(1234.5).text, "1.23e+03");
  EXPECT_EQ(written(1234.5, "{:.1f}").text, "1234.5");
  EXPECT_EQ(written(std::numeric_limits<double>::infinity()).text,
            "not finite");
}

}  // namespace
}  // namespace physinv
