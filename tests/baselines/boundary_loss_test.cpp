#include "baselines/boundary_loss.h"

#include <gtest/gtest.h>

#include <cmath>

#include "suite/core/check.h"
#include "tests/support/gradient_check.h"
#include "tests/support/jpo_entries.h"

namespace physinv {
namespace {

TEST(BoundaryLossReference, Entry) {
  test::check_entries_named(
      "jpo-billiards", "boundary_loss", test::check_boundary);
}

BoundaryLoss wall() {
  Batch<double> samples(2, 3);
  samples << -1, 0.2, 1, 0.5, -0.5, 0.1;
  return BoundaryLoss::over(samples, 5);
}

TEST(BoundaryLoss, AddsWeightedValueAndGradient) {
  for (const double x0 : {-3.0, -0.9, 0.1, 0.8, 1.5}) {
    const Vector<double> x = (Vector<double>(2) << x0, 0.4).finished();
    const auto value = [](const Vector<double>& at) {
      Vector<double> loss = Vector<double>::Constant(1, 2.0);
      Batch<double> ignored = Batch<double>::Zero(2, 1);
      wall().add(at, 3, loss, ignored);
      return loss(0);
    };
    Vector<double> loss = Vector<double>::Constant(1, 2.0);
    Batch<double> g = Batch<double>::Constant(2, 1, 7.0);
    wall().add(x, 3, loss, g);
    const Vector<double> expected =
        test::difference_gradient(value, x).array() + 7.0;
    EXPECT_TRUE(test::Comparator(1e-8, 0)(g, expected));
    EXPECT_EQ(loss(0), value(x));
    EXPECT_GT(loss(0), 2);
  }
}

TEST(BoundaryLoss, FarOutsideStaysFiniteAndLinear) {
  Vector<double> loss = Vector<double>::Zero(2);
  Batch<double> x(2, 2), g = Batch<double>::Zero(2, 2);
  x << 1e300, -1e6, 0, 0;
  wall().add(x, 1, loss, g);
  EXPECT_TRUE(loss.allFinite());
  EXPECT_NEAR(g(0, 0), 0.5, 1e-12);
  EXPECT_NEAR(g(0, 1), -0.5, 1e-12);
}

TEST(BoundaryLoss, MiddleHasNoPull) {
  Vector<double> loss = Vector<double>::Zero(1);
  Batch<double> g = Batch<double>::Zero(2, 1);
  wall().add(Batch<double>::Zero(2, 1), 1, loss, g);
  EXPECT_TRUE(g.isZero(0));
}

TEST(BoundaryLoss, RangesNeedAWidth) {
  const Vector<double> same = Vector<double>::Zero(1);
  EXPECT_THROW(BoundaryLoss(same, same), ContractError);
}

}  // namespace
}  // namespace physinv
