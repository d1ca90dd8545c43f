#include "optimizers/local_steps.h"

#include <cmath>
#include <limits>

#include "optimizers/training/newton.h"
#include "problems/scaling/scaling.h"
#include "problems/scaling/trajectories.h"
#include "suite/core/check.h"
#include "suite/linalg/decompositions.h"
#include "tests/optimizers/scaling_support.h"
#include "tests/support/bits.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

constexpr LocalStep kGradient = LocalStep::gradient;
constexpr LocalStep kNewton = LocalStep::newton;
constexpr LocalStep kInverseGradient = LocalStep::inverse_gradient;
constexpr LocalStep kSimulator = LocalStep::inverse_simulator;

AimedOptions squared(double x1, double x2) {
  return {.scaling = {.power = 2, .start = {x1, x2}}};
}

TEST(LocalSteps, ClosedStepsAreThoseOfTheMatrices) {
  for (const int power : {1, 2})
    for (const double goal : {0.0, 0.7})
      for (const LocalStep step : {kNewton, kInverseGradient}) {
        const AimedOptions o{
            .scaling = {.scales = {3}, .power = power, .start = {2, 1.5}},
            .target = {-0.3, goal}};
        const auto open = run_steps(
            problem<Open>("scaling", o), {.step = step, .rate = 0.3}, 5);
        EXPECT_TRUE(Comparator(1e-12, 0)(open.out.arrays.at("path"),
                                         path_of<double>(o, step, 0.3, 5)));
      }
}

TEST(LocalSteps, SingularPointsHaveTheirLimits) {
  for (const double x2 : {0.0, 1e-170, -1e-170, 1e-300}) {
    SCOPED_TRACE(x2);
    const auto end = [&](LocalStep step) {
      return path_of<double>(squared(1, x2), step, 0.3, 1)(1, 1);
    };
    EXPECT_DOUBLE_EQ(end(kNewton), x2 * (1 - 0.1));
    EXPECT_DOUBLE_EQ(end(kInverseGradient), x2 * (1 - 0.15));
    EXPECT_TRUE(std::isfinite(end(kSimulator)));
    EXPECT_EQ(std::signbit(end(kSimulator)), std::signbit(x2));
  }
}

TEST(LocalSteps, TheInverseKeepsItsBranchAndClampsWhatHasNoRoot) {
  EXPECT_LT(path_of<double>(squared(1, -2), kSimulator, 0.3, 1)(1, 1), 0);
  // eta > 1 asks for a negative square.
  for (const double x2 : {2.0, -2.0}) {
    const double end =
        path_of<double>(squared(1, x2), kSimulator, 1.5, 1)(1, 1);
    EXPECT_EQ(end, 0);
    EXPECT_EQ(std::signbit(end), std::signbit(x2));
  }
}

TEST(LocalSteps, ScalesBeyondTheRootOfTheRange) {
  for (const double alpha : {1e-160, -1e160, 1e200})
    for (const LocalStep step : {kNewton, kInverseGradient, kSimulator}) {
      const AimedOptions o{.scaling = {.scales = {alpha}}};
      const AimedOptions one;
      EXPECT_TRUE(Comparator(1e-13, 0)(path_of<double>(o, step, 0.3, 50),
                                       path_of<double>(one, step, 0.3, 50)));
    }
}

TEST(LocalSteps, WhatOverflowsHasDivergedAndStaysFinite) {
  const auto run = run_steps(problems::scaling({.scales = {1e6, 1}}),
                             {.step = kGradient, .rate = 0.03},
                             60,
                             Precision::f64,
                             2);
  EXPECT_EQ(run.out.status[0], Status::nonfinite);
  EXPECT_EQ(run.out.status[1], Status::maxiter);
  EXPECT_LT(run.out.iterations(0), 60);
  EXPECT_EQ(run.out.iterations(1), 60);
  EXPECT_EQ(run.out.stop, Stop::iterations);
  EXPECT_TRUE(run.out.x.allFinite());
  const auto alone = run_steps(problems::scaling({.scales = {1e6}}),
                               {.step = kGradient, .rate = 0.03},
                               60);
  EXPECT_EQ(alone.out.stop, Stop::diverged);
}

TEST(LocalSteps, PathsAreKeptWhereTheyAreAskedFor) {
  const auto rows = [](Index paths) {
    const auto stage = local_steps({.paths = paths});
    StageBench bench(*stage, 3, 5, problems::scaling());
    const Outcome out = bench.run();
    const auto path = out.arrays.find("path");
    return path == out.arrays.end() ? 0 : path->second.rows();
  };
  EXPECT_EQ(rows(0), 0);
  EXPECT_EQ(rows(2), 2 * 2);
  EXPECT_EQ(rows(9), 3 * 2) << "no more than there are problems";
}

TEST(LocalSteps, SearchFindsTheInversesPath) {
  const Batch<double> exact =
      path_of<double>(squared(3, 3), kSimulator, 0.3, 10);
  const auto mean_distance = [&](const NumericInverseOptions& search) {
    const auto run = run_steps(
        problem<Aimed>("scaling", squared(3, 3)),
        {.step = LocalStep::inverse_search, .rate = 0.3, .search = search},
        10);
    return (run.out.arrays.at("path") - exact).cwiseAbs().mean();
  };
  EXPECT_LE(mean_distance({.difference = 1e-8}), 5e-6);
  EXPECT_LE(mean_distance({.pgtol = 1e-10, .ftol = 0}), 1e-7);
}

TEST(NumericInverse, HasNoneFromWhatIsNotFinite) {
  NumericInverse search(counted_scaling({.power = 2}), {});
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Batch<double> y(2, 4), guess(2, 4), x(2, 4);
  y << 1, 1, 1, kNan, 4, 4, 4, 4;
  guess << 2, kNan, 2, 2, 3, 3, -kInf, 3;
  search.invert(y, Batch<double>::Ones(1, 4), guess, x);
  EXPECT_TRUE(Comparator(1e-4, 0)(x.col(0), Eigen::Vector2d(1, 2)));
  EXPECT_TRUE(x.rightCols(3).array().isNaN().all());
}

TEST(NewtonStep, OfOneUnknownIsNoNumberEither) {
  const auto one = [](double v) { return Batch<double>::Constant(1, 1, v); };
  for (const double bad : {std::nan(""), HUGE_VAL})
    for (const double good : {0.0, 2.0}) {
      EXPECT_TRUE(std::isnan(newton_step({}, one(good), one(bad))(0)));
      EXPECT_TRUE(std::isnan(newton_step({}, one(bad), one(good))(0)));
    }
}

TEST(NewtonStep, AnEigenvalueThatIsZeroButForRoundingIsZero) {
  const Vector<double> g = Vector<double>::Ones(2);
  const auto second = [&](double h, double epsilon, NewtonOptions o = {}) {
    const Batch<double> hessian{{1, 0}, {0, h}};
    const Vector<double> dx = newton_step(o, g, hessian, epsilon);
    EXPECT_DOUBLE_EQ(dx(0), -1 / (1 + o.damping));
    return dx(1);
  };
  constexpr double kDouble = std::numeric_limits<double>::epsilon();
  constexpr double kFloat = std::numeric_limits<float>::epsilon();
  for (const double h : {0.0, 1e-17, -1e-17, 4e-16}) {
    EXPECT_EQ(second(h, kDouble), 0) << h;
    EXPECT_EQ(second(h, kDouble, {.limit = 3}), 0) << h;
    EXPECT_EQ(second(h, kDouble, {.flip = false}), 0) << h;
  }
  EXPECT_DOUBLE_EQ(second(1e-15, kDouble), -1e15);
  EXPECT_DOUBLE_EQ(second(1e-15, kDouble, {.limit = 3}), -3);
  EXPECT_EQ(second(1e-8, kFloat), 0);
  EXPECT_DOUBLE_EQ(second(1e-6, kFloat), -1e6);
  // Damped it is zero no more.
  EXPECT_DOUBLE_EQ(second(1e-17, kDouble, {.damping = 0.5}), -2);
  // Of rank one: the solver's zero is some 1e-17 of the other.
  for (const double slope : {0.1, 0.3, 0.7, 1.1, 3.3}) {
    const Vector<double> v{{1, slope}};
    const Vector<double> dx = newton_step({}, g, v * v.transpose());
    EXPECT_LT(dx.norm(), 2 * g.norm() / v.squaredNorm()) << slope;
  }
}

TEST(FullyPivoted, APivotThatIsZeroButForRoundingIsZero) {
  linalg::FullyPivoted<double> lu;
  Vector<double> x(2);
  for (const double slope : {0.1, 0.3, 0.9, 1.1}) {  // of 0.9 it is 1e-17
    const Batch<double> a{{0.1, 0.3}, {slope * 0.1, slope * 0.3}};
    lu.solve(a, Vector<double>{{1, 2}}, x);
    EXPECT_LT(x.norm(), 100) << slope;
  }
  lu.solve(Batch<double>{{1, 0}, {0, 1e-15}}, Vector<double>{{1, 1}}, x);
  EXPECT_DOUBLE_EQ(x(1), 1e15);
}

TEST(LocalSteps, AStartOfNoUseEndsItsProblemAtOnce) {
  // Beyond 0.4 there are no numbers; the start is at 0.5.
  const auto broken = quadratic({.broken_above = 0.4});
  for (const LocalStep step : {kGradient, LocalStep::inverse_search}) {
    const auto run = run_steps(broken, {.step = step, .rate = 0.1}, 5);
    EXPECT_EQ(run.out.status[0], Status::nonfinite);
    EXPECT_EQ(run.out.stop, Stop::diverged);
    EXPECT_EQ(run.out.iterations(0), 0);
    EXPECT_EQ(run.out.x(0, 0), 0.5);
  }
}

TEST(LocalSteps, RefusesOptionsThatAreNoNumbers) {
  const double nan = std::nan("");
  EXPECT_THROW(local_steps({.rate = nan}), ContractError);
  EXPECT_THROW(local_steps({.iterations = -1}), ContractError);
  EXPECT_THROW(local_steps({.paths = -1}), ContractError);
  for (const NumericInverseOptions& bad :
       {NumericInverseOptions{.difference = nan},
        NumericInverseOptions{.difference = -1}})
    EXPECT_THROW(NumericInverse(counted_scaling(), bad), ContractError);
  // A rate that is 0 in float.
  EXPECT_THROW(
      run_steps(problems::scaling(), {.rate = 1e-60}, 1, Precision::f32),
      ContractError);
}

TEST(LocalSteps, AdamsFirstStepIsAsLongAsItsRate) {
  const auto run =
      run_steps(problem<Aimed>("scaling", squared(3, 3)),
                {.rule = StepOptions(AdamOptions{.rate = 0.1, .eps = 1e-8})},
                100);
  const Batch<double>& path = run.out.arrays.at("path");
  EXPECT_TRUE(Comparator(1e-8, 0)(path.col(1), Eigen::Vector2d(2.9, 2.9)));
  EXPECT_LT(path.col(100).norm(), 0.5);
}

// The printed digits, and PG's straight line in y.
TEST(LocalSteps, SinglePrecisionKeepsWhatIsPrinted) {
  const auto end = [](LocalStep step, double rate) {
    return Vector<double>(
        path_of<float>(squared(3, 3), step, rate, 10).col(10));
  };
  const Comparator printed(0, 2e-6);
  EXPECT_TRUE(
      printed(end(kGradient, 0.01), Eigen::Vector2d(2.4512184, 0.96171147)));
  EXPECT_TRUE(
      printed(end(kNewton, 1.0 / 3), Eigen::Vector2d(0.05202458, 0.92383826)));
  EXPECT_TRUE(
      printed(end(kSimulator, 0.3), Eigen::Vector2d(0.08474258, 0.50421)));
  const Batch<double> x = path_of<float>(squared(3, 3), kSimulator, 0.3, 10);
  EXPECT_LE((x.row(1).cwiseAbs2() - 3 * x.row(0)).cwiseAbs().maxCoeff(), 1e-5);
}

// Registers full and not: 37 problems from one start, alpha of each.
template <class T>
void expect_flow_of_stages(double tolerance) {
  constexpr Index kCount = 37, kSteps = 10;
  for (const int power : {1, 2})
    for (const LocalStep step :
         {kGradient, kNewton, kInverseGradient, kSimulator}) {
      SCOPED_TRACE(testing::Message() << power << " " << int(step));
      const double rate = step == kGradient ? 0.003 : 0.3;
      const ScalingOptions o{.scales = {1}, .power = power, .start = {2, -1.5}};
      const auto recipe = problems::scaling(o);
      const auto run =
          run_steps(recipe,
                    {.step = step, .rate = rate},
                    kSteps,
                    sizeof(T) == 4 ? Precision::f32 : Precision::f64,
                    kCount);
      Vector<T> alpha = run.given.row(0).transpose().template cast<T>();
      Vector<T> x1 = Vector<T>::Constant(kCount, 2),
                x2 = Vector<T>::Constant(kCount, T(-1.5));
      advance<T>({.step = static_cast<ScalingStep>(step),
                  .power = power,
                  .rate = rate,
                  .steps = kSteps},
                 alpha,
                 x1,
                 x2,
                 x1,
                 x2);
      Batch<T> x(2, kCount);
      x << x1.transpose(), x2.transpose();
      EXPECT_TRUE(Comparator(tolerance, 0)(x, run.out.x));
    }
}

TEST(ScalingTrajectories, AreThoseOfTheStages) {
  expect_flow_of_stages<double>(1e-13);
  expect_flow_of_stages<float>(1e-5);
}

TEST(ScalingTrajectories, BitsOfOneDependOnNoOtherAndNoThread) {
  constexpr Index kCount = 10'001;
  const Vector<double> alpha = Vector<double>::LinSpaced(kCount, 1, 5);
  for (const int power : {1, 2}) {
    const ScalingFlow flow{.power = power, .rate = 0.003};
    const Vector<double> start = Vector<double>::LinSpaced(kCount, -2, 3);
    Vector<double> x1(kCount), x2(kCount), y1 = start, y2 = start;
    advance<double>(flow, alpha, start, start, x1, x2);
    Threads threads(3);
    advance<double>(flow, alpha, y1, y2, y1, y2, &threads);
    EXPECT_TRUE(same_bits(x1, y1));
    EXPECT_TRUE(same_bits(x2, y2));
    for (const Index i : {0, 1, 4095, 4096, 9999, 10'000}) {
      Vector<double> z1 = start.segment(i, 1), z2 = z1;
      advance<double>(flow, alpha.segment(i, 1), z1, z2, z1, z2);
      EXPECT_TRUE(same_bits(z1, Vector<double>(x1.segment(i, 1))));
      EXPECT_TRUE(same_bits(z2, Vector<double>(x2.segment(i, 1))));
    }
  }
}

TEST(ScalingTrajectories, WithoutARootTheSignStays) {
  Vector<double> x1(2), x2(2), alpha = Vector<double>::Constant(2, 1e200);
  x1 << 1, 1, x2 << 2, -2;
  advance<double>({.step = ScalingStep::inverse_simulator,
                   .power = 2,
                   .rate = 1.5,
                   .steps = 1},
                  alpha,
                  x1,
                  x2,
                  x1,
                  x2);
  EXPECT_EQ(x1, Vector<double>::Constant(2, -0.5));
  EXPECT_EQ(x2, Vector<double>::Zero(2));
  EXPECT_FALSE(std::signbit(x2(0)));
  EXPECT_TRUE(std::signbit(x2(1)));
}

}  // namespace
}  // namespace physinv::test
