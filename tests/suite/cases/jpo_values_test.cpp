// What claims read out of the chains of the JPO paper's experiments.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "problems/billiards/billiards.h"
#include "suite/cases/jpo/common/values.h"
#include "suite/results/published.h"
#include "tests/suite/evidence/campaigns.h"

namespace physinv::jpo {
namespace {

/// A stage with iterations of each example and a curve from `start`.
StageRecord solver(const std::vector<double>& loss,
                   const std::vector<double>& start,
                   const std::vector<double>& iterations) {
  StageRecord s = stage_of("solve", loss, start);
  s.example_iterations = physinv::losses(iterations);
  return s;
}

class JpoValues : public testing::Test {
 protected:
  JpoValues()
      : results_(
            {case_of("bfgs",
                     4,
                     0,
                     {"solve"},
                     {solver({0.5, 1e-9, 0.5, 0}, {1, 1, 1, 1}, {3, 9, 4, 5})}),
             case_of("bfgs",
                     8,
                     0,
                     {"solve"},
                     {solver(std::vector<double>(8, 0.5),
                             std::vector<double>(8, 1),
                             std::vector<double>(8, 7))}),
             case_of("bfgs",
                     4,
                     1,
                     {"solve"},
                     {solver({0.5, 0.5, 0, 0}, {1, 1, 1, 1}, {2, 2, 2, 2})}),
             case_of("jpo",
                     4,
                     0,
                     {"fit", "refine"},
                     {stage_of("fit", {1e-3, 1e-3, 0.5, 2}, {1, 1, 0.5, 2}),
                      stage_of("refine", {1e-9, 0, 0.5, 3})}),
             case_of("jpo",
                     8,
                     0,
                     {"fit", "refine"},
                     {stage_of("fit", std::vector<double>(8, 0.5)),
                      stage_of("refine", std::vector<double>(8, 0))})}) {}

  Measured of(const Quantity& q) const { return q(evidence_); }
  double value(const Quantity& q) const { return of(q).value.value_or(-1); }

  Results results_;
  Published published_;
  Evidence evidence_{results_, published_, "toy"};
};

TEST_F(JpoValues, SharesAgainstBfgs) {
  // Fit: lower once, equal once; refined: lower twice, equal once.
  EXPECT_DOUBLE_EQ(value(mean(at(plain("jpo"), 4), better())), 0.25);
  EXPECT_DOUBLE_EQ(value(mean(at(plain("jpo"), 4), equal())), 0.25);
  EXPECT_DOUBLE_EQ(value(mean(at(refined("jpo"), 4), better())), 0.5);
  EXPECT_DOUBLE_EQ(value(mean(at(refined("jpo"), 4), f())), 0.625);
  EXPECT_FALSE(of(mean(plain("na"), better())).value);
}

TEST_F(JpoValues, WhatARefinementChanges) {
  EXPECT_DOUBLE_EQ(value(highest(refined("jpo"), worsened())), 1);
  EXPECT_FALSE(of(highest(plain("jpo"), worsened())).value);
  EXPECT_NEAR(value(mean(at(refined("jpo"), 4), decrease_before())),
              0.5 * (0.999 / (1 - 1e-9) + 0.999),
              1e-12);
}

TEST_F(JpoValues, SolvedAndGain) {
  EXPECT_DOUBLE_EQ(value(mean(at(refined("jpo"), 4), solved(1e-6))), 0.5);
  EXPECT_DOUBLE_EQ(value(mean(refined("jpo"), gain(1e-6))), 0.5);
  // Two problems of n = 4 are left by BFGS, and all of n = 8.
  const RunRow rescued = where(bfgs_unsolved(1e-6), if_solved(1e-6));
  EXPECT_DOUBLE_EQ(
      value(share_of_examples(at(refined("jpo"), 4), rescued, holds)), 0.5);
  EXPECT_DOUBLE_EQ(value(share_of_examples(refined("jpo"), rescued, holds)),
                   0.9);
}

TEST_F(JpoValues, OnlyTheLargestSetsOfASeed) {
  EXPECT_DOUBLE_EQ(value(problem_count(bfgs())), 12);
  const Quantity share =
      share_of_examples(bfgs(), largest_sets(if_solved(1e-6)), holds);
  EXPECT_DOUBLE_EQ(value(share), 2.0 / 12);
  EXPECT_DOUBLE_EQ(value(from_problems(12, bfgs(), share)), 2.0 / 12);
  EXPECT_FALSE(of(from_problems(13, bfgs(), share)).value);
  EXPECT_DOUBLE_EQ(
      value(highest(bfgs(), largest_sets(of_row(iterations(), most_of)))), 7);
}

TEST_F(JpoValues, ExtremesOfMeansOverSeeds) {
  const RunValue its = of_row(iterations(), mean_of);
  // n = 4: 5.25 and 2; n = 8: 7.
  EXPECT_DOUBLE_EQ(value(lowest_mean(bfgs(), its)), 3.625);
  EXPECT_DOUBLE_EQ(value(highest_mean(bfgs(), its)), 7);
}

TEST_F(JpoValues, WhereALossIsFirstReached) {
  const auto run = find_runs(evidence_, at(bfgs(), 4)).front();
  constexpr double kNever = std::numeric_limits<double>::infinity();
  EXPECT_EQ(first_below(1e-6)(run),
            (std::vector<double>{kNever, 5, kNever, 5}));
  EXPECT_EQ(first_below(2)(run), (std::vector<double>{0, 0, 0, 0}));
  EXPECT_EQ(start_losses()(run), (std::vector<double>{1, 1, 1, 1}));
}

TEST(JpoTraining, EndsAtOrBeyondTheTrainingSamples) {
  const auto recipe = problems::billiards();
  const Batch<double> samples =
      recipe.make<double>()
          ->sample_labelled(0, 4, Rng::root("toy", 0).child("data/train"))
          .x;
  const Vector<double> low = samples.rowwise().minCoeff(),
                       high = samples.rowwise().maxCoeff();
  StageRecord s = stage_of("solve", {1, 1, 1, 1}, {1, 1, 1, 1});
  const double inner[] = {0.5, 0.985, -2, 0.97};
  for (Index i = 0; i < 4; ++i)
    for (Index j = 0; j < 2; ++j)
      s.curve.x(2 * i + j, 1) =
          low(j) + (high(j) - low(j)) * (j == 0 ? inner[i] : 0.5);
  const Results results({case_of("na", 4, 0, {"solve"}, {s})});
  const Published published;
  const Evidence evidence{results, published, "toy"};
  const auto run = find_runs(evidence, plain("na")).front();
  EXPECT_EQ(beyond_training(recipe, 0.02)(run),
            (std::vector<double>{0, 1, 1, 0}));
  EXPECT_EQ(last_tracked(1)(run).size(), 4U);
}

}  // namespace
}  // namespace physinv::jpo
