#include "problems/oscillators/oscillators.h"

#include "suite/core/any_problem.h"
#include "tests/problems/physics_checks.h"

namespace physinv::test {
namespace {

const Rng kRng = Rng::root("oscillators_test", 1);

TEST(Oscillators, DerivativesAgreeWithDifferences) {
  for (const double g : {1.0, 4.0, 0.0}) {
    SCOPED_TRACE(g);
    const AnyProblem<double> pair(problems::oscillators({.coupling = g}));
    const auto s = pair.sample_labelled(0, 5, kRng);
    expect_derivatives(pair, s.x, s.given);
  }
}

TEST(Oscillators, AnyNumberOfSteps) {
  for (const Index steps : {1, 2, 3, 5, 97}) {
    SCOPED_TRACE(steps);
    const AnyProblem<double> pair(problems::oscillators({.steps = steps}));
    const auto s = pair.sample_labelled(0, 9, kRng);
    expect_derivatives(pair, s.x, s.given);
    expect_independent_samples<double>(pair, s.x, s.given);
  }
}

template <class T>
void check_contained() {
  const AnyProblem<T> pair(problems::oscillators());
  const auto s = pair.sample_labelled(0, 19, kRng).template cast<T>();
  for (const T u : {std::numeric_limits<T>::quiet_NaN(),
                    std::numeric_limits<T>::infinity(),
                    T(400),
                    std::numeric_limits<T>::max()}) {
    SCOPED_TRACE(u);
    Batch<T> x = s.x;
    x.col(7).setConstant(u);
    expect_contained<T>(pair, s.x, s.given, x, 7);
  }
  Batch<T> x = s.x;
  x(3, 18) = std::numeric_limits<T>::quiet_NaN();
  expect_contained<T>(pair, s.x, s.given, x, 18);
}

TEST(Oscillators, DivergenceStaysInItsColumn) {
  check_contained<float>();
  check_contained<double>();
}

/// H = |p|^2 / 2 + |x|^2 / 2 + g (x2 - x1)^4 / 4
double energy(const Vector<double>& s, double g) {
  const double d = s(1) - s(0);
  return s.squaredNorm() / 2 + g * d * d * d * d / 4;
}

TEST(Oscillators, EnergyIsConservedWithoutControlToFourthOrder) {
  const Rng rng = Rng::root("oscillators_test/energy", 1);
  double error[2] = {0, 0};
  for (int fine = 0; fine < 2; ++fine) {
    const Index steps = fine == 1 ? 192 : 96;
    const AnyProblem<double> pair(
        problems::oscillators({.steps = steps, .dt = 12.0 / double(steps)}));
    const auto s = pair.sample(0, 16, rng);
    Physics at(pair);
    const Batch<double> y = at.forward(Batch<double>::Zero(steps, 16), s.given);
    for (Index i = 0; i < 16; ++i)
      error[fine] = std::max(
          error[fine],
          std::abs(energy(y.col(i), 1) / energy(s.given.col(i), 1) - 1));
  }
  EXPECT_LT(error[0], 1e-3);
  EXPECT_LT(error[1], error[0] / 12);  // 2^4, or 2^5 for the drift of RK4
}

TEST(Oscillators, CouplingActsOnTheDifferenceOnly) {
  // The momenta of a pair without control sum to those of one free oscillator.
  const AnyProblem<double> coupled(problems::oscillators({.coupling = 4})),
      free(problems::oscillators({.coupling = 0}));
  const auto s = coupled.sample(0, 11, kRng);
  const Batch<double> x = Batch<double>::Zero(96, 11);
  Physics a(coupled), b(free);
  const Batch<double> u = a.forward(x, s.given), v = b.forward(x, s.given);
  for (const Index r : {0, 2}) {
    EXPECT_TRUE(Comparator(1e-13, 0)((u.row(r) + u.row(r + 1)).eval(),
                                     (v.row(r) + v.row(r + 1)).eval()));
  }
  EXPECT_GT((u - v).norm(), 0.1);
}

TEST(Oscillators, LossIsTheWholeSquareOfTheMiss) {
  const AnyProblem<float> pair(problems::oscillators());
  Batch<float> y(4, 2), target(4, 2), g(4, 2);
  y << 1, 0, 2, 0, 3, 0, 4, 1;
  target << 0, 0, 0, 0, 0, 0, 0, 3;
  Vector<double> loss(2);
  pair.loss(y, target, loss);
  EXPECT_EQ(loss(0), 30);
  EXPECT_EQ(loss(1), 4);
  pair.loss_gradient(y, target, g);
  EXPECT_TRUE(same_bits(g, Batch<float>(2 * (y - target))));
}

TEST(Oscillators, StatesAreDrawnUniformlyAndWantedBack) {
  const AnyProblem<double> pair(problems::oscillators());
  const auto s = pair.sample(0, 4096, kRng);
  EXPECT_EQ(s.x.rows(), 0);
  EXPECT_TRUE(same_bits(s.y, s.given));
  EXPECT_GE(s.y.minCoeff(), 0);
  EXPECT_LT(s.y.maxCoeff(), 1);
  EXPECT_NEAR(s.y.mean(), 0.5, 0.01);
  // What doing nothing costs.
  Physics at(pair);
  Vector<double> loss(4096);
  pair.loss(at.forward(Batch<double>::Zero(96, 4096), s.given), s.y, loss);
  EXPECT_NEAR(loss.mean(), 0.80, 0.05);
}

TEST(Oscillators, TakesNoMoreMemoryAndLittleOfIt) {
  const AnyProblem<double> pair(problems::oscillators());
  const auto s = pair.sample_labelled(0, 512, kRng);
  Physics at(pair);
  at.gradient(s.x, s.given, s.y);
  EXPECT_LE(at.tape.bytes(), std::size_t{2} << 20);
  Batch<double> j = at.jacobian(s.x, s.given);
  const std::size_t bytes = at.work.bytes();
  EXPECT_LE(bytes, std::size_t{128} << 10);
  j = at.jacobian(s.x, s.given);
  EXPECT_EQ(at.work.bytes(), bytes);
}

TEST(Oscillators, RejectsWrongSizes) {
  const AnyProblem<double> pair(problems::oscillators());
  Workspace work;
  Batch<double> x(95, 2), given(4, 2), y(4, 2);
  x.setZero(), given.setZero();
  EXPECT_THROW(pair.forward(x, given, y, work), ContractError);
  EXPECT_THROW(AnyProblem<double>(problems::oscillators({.steps = 0})),
               ContractError);
}

}  // namespace
}  // namespace physinv::test
