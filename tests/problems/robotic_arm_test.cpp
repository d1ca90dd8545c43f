#include "problems/robotic_arm/robotic_arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "optimizers/bfgs.h"
#include "optimizers/drive.h"
#include "optimizers/gradient_descent.h"
#include "suite/core/any_problem.h"
#include "suite/core/check.h"
#include "tests/support/bits.h"
#include "tests/support/gradient_check.h"
#include "tests/support/physics.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

template <class T>
Batch<T> none(const Batch<T>& x) {
  return Batch<T>(0, x.cols());
}

template <class T>
Batch<T> tips(const Batch<T>& x) {
  return Physics{AnyProblem<T>(problems::robotic_arm())}.forward(x, none(x));
}

template <class T>
Batch<T> jacobians(const Batch<T>& x) {
  return Physics{AnyProblem<T>(problems::robotic_arm())}.jacobian(x, none(x));
}

template <class T>
Batch<T> pulled(const Batch<T>& x, const Batch<T>& y_bar) {
  return Physics{AnyProblem<T>(problems::robotic_arm())}.gradient(
      x, none(x), y_bar);
}

Samples<double> draw(Index n, std::uint64_t seed = 1) {
  return AnyProblem<double>(problems::robotic_arm())
      .sample(0, n, Rng::root("test/arm", seed));
}

/// The loss of every arm against one target.
auto reaching(const Eigen::Vector2d& target) {
  return [target](std::span<const Index>,
                  BatchIn<double> x,
                  VectorOut<double> loss,
                  BatchOut<double> gradient) {
    const Batch<double> r = tips<double>(x).colwise() - target;
    loss = 0.5 * r.colwise().squaredNorm().transpose();
    gradient = pulled<double>(x, r);
  };
}

template <class T>
class RoboticArmIn : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(RoboticArmIn, Scalars);

TEST(RoboticArm, KnownPoses) {
  const double right = std::numbers::pi / 2;
  Batch<double> x(4, 3), y(2, 3);
  x.col(0) << 0, 0, 0, 0;           // stretched
  x.col(1) << 0.25, right, 0, 0;    // up, down, down
  x.col(2) << -1, 0, right, right;  // level, up, level
  y.col(0) << 2, 0;
  y.col(1) << 0, 0.25 + 0.5 - 0.5 - 1;
  y.col(2) << 1.5, -0.5;
  EXPECT_TRUE(Comparator(1e-15, 0)(tips(x), y));
}

TEST(RoboticArm, JointsFollowTheLinks) {
  const auto s = draw(50);
  const RoboticArmOptions o;
  for (Index i = 0; i < 50; ++i) {
    const auto at = arm_joints({s.x(0, i), s.x(1, i), s.x(2, i), s.x(3, i)});
    EXPECT_EQ(at[0][0], 0);
    EXPECT_EQ(at[0][1], s.x(0, i));
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(std::hypot(at[k + 1][0] - at[k][0], at[k + 1][1] - at[k][1]),
                  o.links[k],
                  1e-15);
    EXPECT_NEAR(at[3][0], s.y(0, i), 1e-15);
    EXPECT_NEAR(at[3][1], s.y(1, i), 1e-15);
  }
}

TEST(RoboticArm, JacobianAgreesWithCentralDifferences) {
  const auto s = draw(40);
  const Batch<double> j = jacobians(s.x);
  for (Index i = 0; i < 40; ++i) {
    const auto d = difference_jacobian(
        [](const Vector<double>& x) {
          return Vector<double>(tips<double>(x).col(0));
        },
        s.x.col(i));
    const Eigen::Map<const Eigen::Matrix<double, 2, 4>> ji(j.col(i).data());
    EXPECT_TRUE(Comparator(1e-9, 0)(ji, d));
  }
}

TYPED_TEST(RoboticArmIn, PullbackIsTheTransposedJacobian) {
  using T = TypeParam;
  const Batch<T> x = draw(75).x.template cast<T>();
  const Batch<T> y_bar = draw(75, 2).y.template cast<T>();
  const Batch<T> x_bar = pulled(x, y_bar), j = jacobians(x);
  for (Index i = 0; i < 75; ++i) {
    const Eigen::Map<const Eigen::Matrix<T, 2, 4>> ji(j.col(i).data());
    EXPECT_TRUE(Comparator(8 * std::numeric_limits<T>::epsilon(), 0)(
        x_bar.col(i), ji.transpose() * y_bar.col(i)));
  }
}

TYPED_TEST(RoboticArmIn, EmptyBatchesAndMemory) {
  using T = TypeParam;
  const AnyProblem<T> arm(problems::robotic_arm());
  Tape tape;
  Workspace work;
  for (const Index n : {128, 0, 3, 128}) {
    const Batch<T> x = draw(n).x.template cast<T>(), given(0, n);
    Batch<T> y(2, n), x_bar(4, n);
    arm.linearize(x, given, y, tape);
    arm.pullback(tape, y, x_bar, work);
    EXPECT_LE(tape.bytes(), 128 * 6 * sizeof(T) + kAlignment);
  }
  EXPECT_EQ(work.bytes(), 0U);
}

TEST(RoboticArm, LargeAnglesKeepTheirDigits) {
  constexpr double kPi = std::numbers::pi;
  const auto s = draw(30);
  for (const double turns : {1.0, 100.0, 1.0e6 / (2 * kPi)}) {
    Batch<double> x = s.x;
    x.row(3).array() += 2 * kPi * std::floor(turns);
    EXPECT_LT((tips(x) - s.y).cwiseAbs().maxCoeff(), 1e-9);
  }
  Batch<double> far = s.x;
  far.row(1).setConstant(1e300);
  EXPECT_TRUE(tips(far).allFinite());
}

// ---- poses where optimizers meet the singularity --------------------------

TEST(RoboticArm, TheTargetAtTheStartNeedsNoStep) {
  Bfgs bfgs({.gtol = 1e-10});
  drive(bfgs, reaching({2, 0}), Batch<double>::Zero(4, 1));
  EXPECT_EQ(bfgs.status()[0], Status::gtol);
  EXPECT_EQ(bfgs.iterations()[0], 0);
  EXPECT_EQ(bfgs.loss()(0), 0);
}

TEST(RoboticArm, TargetsOnTheAxisOfTheStretchedPoseEndAtOnce) {
  Bfgs bfgs({.gtol = 1e-10});
  drive(bfgs, reaching({1.5, 0}), Batch<double>::Zero(4, 1));
  EXPECT_EQ(bfgs.iterations()[0], 0);
  EXPECT_EQ(bfgs.loss()(0), 0.125);
  GradientDescent descent({.step_tolerance = 1e-10});
  drive(descent, reaching({1.5, 0}), Batch<double>::Zero(4, 1));
  EXPECT_EQ(descent.status()[0], Status::gtol);
  EXPECT_EQ(descent.iterations()[0], 1);
}

TEST(RoboticArm, TargetsOutOfReachKeepTheirDistance) {
  Bfgs bfgs({.gtol = 1e-10});
  drive(bfgs, reaching({2.5, 0.3}), Batch<double>::Zero(4, 1));
  EXPECT_NE(bfgs.status()[0], Status::nonfinite);
  EXPECT_NEAR(bfgs.loss()(0), 0.125, 1e-8);
}

// ---- data -----------------------------------------------------------------

TEST(RoboticArm, SamplesHaveTheirDistribution) {
  constexpr Index n = 20000;
  const auto s = draw(n);
  const RoboticArmOptions o;
  for (Index j = 0; j < 4; ++j) {
    const double sigma = o.deviation[static_cast<std::size_t>(j)];
    EXPECT_NEAR(s.x.row(j).mean(), 0, 4 * sigma / std::sqrt(n));
    EXPECT_NEAR(s.x.row(j).squaredNorm() / n, sigma * sigma, 0.01);
    for (Index k = 0; k < j; ++k)
      EXPECT_NEAR(s.x.row(j).dot(s.x.row(k)) / n, 0, 0.01);
  }
  EXPECT_LE(s.y.row(0).cwiseAbs().maxCoeff(), 2);
  EXPECT_TRUE(same_bits(tips(s.x), s.y));
}

TEST(RoboticArm, ChecksItsContract) {
  const AnyProblem<double> arm(problems::robotic_arm());
  Batch<double> x(3, 2), given(0, 2), y(2, 2);
  Workspace work;
  EXPECT_THROW(arm.forward(x, given, y, work), ContractError);
  EXPECT_THROW(AnyProblem<double>(problems::robotic_arm({.links = {1, 0, 1}})),
               ContractError);
  EXPECT_THROW(
      AnyProblem<double>(problems::robotic_arm({.deviation = {1, 1, -1, 1}})),
      ContractError);
}

}  // namespace
}  // namespace physinv::test
