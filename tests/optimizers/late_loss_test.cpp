#include "optimizers/training/late_loss.h"

#include <gtest/gtest.h>

#include <cmath>

#include "problems/exponential/exponential.h"

namespace physinv::test {
namespace {

TEST(LateLoss, IsTheMeanOfTheProblemsOwn) {
  const LateError late = late_loss(problems::exponential(), 0.5);
  EXPECT_EQ(late.name, "loss");
  EXPECT_EQ(late.share, 0.5);
  Batch<double> x(1, 2), y(1, 2);
  x << -1, -2;
  y << 1, 0.5;
  const double a = std::exp(-1) - 1, b = std::exp(-2) - 0.5;
  EXPECT_NEAR(late.of(x, y), 0.25 * (a * a + b * b), 1e-15);
}

}  // namespace
}  // namespace physinv::test
