// What the stress of half-inverse updates finds where the answer is known, and
// the cells in which it once found something wrong.
#include "suite/diagnostics/half_inverse_stress.h"

#include <gtest/gtest.h>

#include <limits>

#include "optimizers/half_inverse/half_inverse.h"
#include "problems/scaled_output/scaled_output.h"
#include "suite/nn/mlp.h"
#include "tests/support/quadratic.h"

namespace physinv::test {
namespace {

struct Found {
  Arrays arrays;

  double get(ArrayKey name, Index cell, Index row = 0) const {
    return arrays.at(name)(row, cell);
  }
  StressStatus status(Index cell) const {
    return static_cast<StressStatus>(static_cast<int>(get("status", cell)));
  }
  Index cells() const { return arrays.at("status").cols(); }
};

/// Cells of one problem, tau, kappa, start and number of samples: once and
/// twice (faster), in float and double.
enum : Index { kOnceFloat, kTwiceFloat, kOnceDouble, kTwiceDouble };

Found stress(double gamma,
             double tau,
             double kappa,
             StressStart start,
             Index samples = 4,
             double rate = 1) {
  const auto recipe = problems::scaled_output({.gamma = gamma});
  const auto stage = half_inverse_stress({.problems = {recipe},
                                          .taus = {tau},
                                          .kappas = {kappa},
                                          .starts = {std::move(start)},
                                          .samples = {samples},
                                          .rate = rate});
  const Setting setting{
      .predictor = {{Field::given},
                    nn::mlp({.hidden = {7},
                             .activation = nn::Activation::tanh,
                             .init = nn::Init::glorot})}};
  Found found{StageBench(*stage, 1, 1, recipe, setting).run().arrays};
  EXPECT_EQ(found.cells(), 4);
  for (const auto& [name, array] : found.arrays)
    EXPECT_TRUE(array.allFinite()) << name;
  return found;
}

TEST(HalfInverseStress, AxesVaryInOrder) {
  const auto found = stress(1, 1e-6, -0.5, {"as drawn"});
  const auto& cell = found.arrays.at("cell");
  for (Index j = 0; j < 4; ++j) {
    EXPECT_EQ(cell(static_cast<Index>(StressAxis::copies), j), j % 2);
    EXPECT_EQ(cell(static_cast<Index>(StressAxis::precision), j), j / 2);
    EXPECT_EQ(found.get("rows", j), 8 * (1 + j % 2));
  }
}

TEST(HalfInverseStress, GoodConditionsAreFine) {
  for (const Index samples : {4, 20}) {
    const auto found = stress(1, 1e-2, -0.5, {"as drawn"}, samples, 0.05);
    for (Index j = 0; j < 4; ++j) {
      EXPECT_EQ(found.status(j), StressStatus::ok);
      EXPECT_LT(found.get("loss", j, 1), found.get("loss", j, 0));
      EXPECT_GT(found.get("norm", j), 0);
      EXPECT_LE(found.get("size", j), 1 + 1e-6);
    }
    EXPECT_NEAR(found.get("norm", kOnceFloat),
                found.get("norm", kOnceDouble),
                1e-3 * found.get("norm", kOnceDouble));
  }
}

TEST(HalfInverseStress, AJacobianOfZerosGivesNoUpdate) {
  const auto found = stress(1, 1e-6, -1, {"blind", 1, true});
  for (Index j = 0; j < 4; ++j) {
    EXPECT_EQ(found.status(j), StressStatus::zero);
    EXPECT_EQ(found.get("norm", j), 0);
    EXPECT_EQ(found.get("loss", j, 1), found.get("loss", j, 0));
  }
}

TEST(HalfInverseStress, WhatIsNotFiniteHasAStatus) {
  const auto found = stress(
      1, 1e-6, -0.5, {"broken", std::numeric_limits<double>::infinity()});
  for (Index j = 0; j < 4; ++j) {
    EXPECT_EQ(found.status(j), StressStatus::nonfinite);
    EXPECT_EQ(found.get("loss", j), -1);
  }
}

// An overflow in float is refused; the weights stay what they were. Double has
// room for the same update, and then for weights whose loss overflows.
TEST(HalfInverseStress, AnUpdateThatOverflowsChangesNothing) {
  const auto found = stress(1, 0, -1, {"x 1000", 1e3});
  EXPECT_EQ(found.status(kTwiceFloat), StressStatus::nonfinite);
  EXPECT_EQ(found.get("loss", kTwiceFloat, 1),
            found.get("loss", kTwiceFloat, 0));
}

// Two singular values, one on the cut: the kept set is in doubt, every path is
// tried, and the last one has to orthogonalise columns of rounding errors.
TEST(HalfInverseStress, EmptyNetworksDoNotStall) {
  for (const double kappa : {-0.5, -1.0}) {
    const auto found = stress(1e-6, 1e-6, kappa, {"all zero", 0});
    for (Index j = 0; j < 4; ++j)
      EXPECT_NE(found.status(j), StressStatus::nonfinite) << j;
  }
}

// Small singular values are found through J^T, which must be that of the rows
// of J in float, not one of its roundings.
TEST(HalfInverseStress, FloatKeepsNoNoise) {
  const auto empty = stress(1e-2, 1e-10, -0.5, {"all zero", 0});
  const auto drawn = stress(1, 1e-10, -0.5, {"as drawn"});
  for (const Found* found : {&empty, &drawn}) {
    EXPECT_EQ(found->get("kept", kTwiceFloat), found->get("kept", kOnceFloat));
    for (Index j = 0; j < 4; ++j) {
      if (found->status(j) == StressStatus::ok) {
        EXPECT_LE(found->get("size", j), 1 + 1e-6) << j;
      }
    }
  }
}

}  // namespace
}  // namespace physinv::test
