#include "problems/quantum_dipole/quantum_dipole.h"

#include <complex>

#include "suite/core/any_problem.h"
#include "tests/problems/physics_checks.h"
#include "tests/support/bits.h"

namespace physinv::test {
namespace {

const Rng kRng = Rng::root("quantum_dipole_test", 1);

template <class T>
Batch<T> none(Index n) {
  return Batch<T>(0, n);
}

/// Normal controls of deviation `scale`.
Batch<double> controls(Index steps, Index n, double scale) {
  return AnyProblem<double>(
             problems::quantum_dipole({.steps = steps, .deviation = scale}))
      .sample_labelled(0, n, kRng)
      .x;
}

TEST(QuantumDipole, DerivativesAgreeWithDifferences) {
  const AnyProblem<double> box(problems::quantum_dipole());
  expect_derivatives(box, controls(384, 3, 0.3), none<double>(3), 1e-6);
}

TEST(QuantumDipole, AnyNumberOfSteps) {
  for (const Index steps : {1, 2, 3, 5, 11}) {
    SCOPED_TRACE(steps);
    const AnyProblem<double> box(problems::quantum_dipole({.steps = steps}));
    const Batch<double> x = controls(steps, 9, 0.5);
    expect_derivatives(box, x, none<double>(9), 1e-6);
    expect_independent_samples<double>(box, x, none<double>(9));
  }
}

template <class T>
void check_contained() {
  const AnyProblem<T> box(problems::quantum_dipole());
  const Batch<T> good = controls(384, 19, 0.1).template cast<T>();
  for (const T u : {std::numeric_limits<T>::quiet_NaN(),
                    std::numeric_limits<T>::infinity(),
                    -std::numeric_limits<T>::infinity(),
                    std::numeric_limits<T>::max()}) {
    SCOPED_TRACE(u);
    Batch<T> x = good;
    x.col(7).setConstant(u);
    expect_contained<T>(box, good, none<T>(19), x, 7);
    x = good;
    x(3, 18) = u;
    expect_contained<T>(box, good, none<T>(19), x, 18);
  }
}

TEST(QuantumDipole, DivergenceStaysInItsColumn) {
  check_contained<float>();
  check_contained<double>();
}

TEST(QuantumDipole, TheNormIsConserved) {
  for (const double scale : {0.0, 0.3, 30.0, 3000.0, 1e7}) {
    SCOPED_TRACE(scale);
    const Batch<double> x = controls(384, 8, scale);
    const AnyProblem<double> box(problems::quantum_dipole());
    Physics at(box);
    const Batch<double> y = at.forward(x, none<double>(8));
    EXPECT_LE((y.colwise().norm().array() - 1).abs().maxCoeff(), 1e-12);
    const AnyProblem<float> rough(problems::quantum_dipole());
    Physics rounded(rough);
    const Batch<float> z = rounded.forward(x.cast<float>(), none<float>(8));
    EXPECT_LE((z.colwise().norm().array() - 1).abs().maxCoeff(), 1e-4);
    if (scale < 1) {
      EXPECT_TRUE(Comparator(1e-4, 0)(z, y));
    }
  }
}

TEST(QuantumDipole, NoControlMovesTheStateAlongItself) {
  const AnyProblem<double> box(problems::quantum_dipole());
  Physics at(box);
  const Batch<double> x = controls(384, 6, 0.3);
  const Batch<double> psi = at.linearize(x, none<double>(6));
  const double scale = at.pullback(waves<double>(28, 6, 0.1)).norm();
  EXPECT_LE(at.pullback(psi).norm(), 1e-12 * scale);
}

TEST(QuantumDipole, WithoutControlOnlyThePhaseTurns) {
  const AnyProblem<double> box(problems::quantum_dipole());
  Physics at(box);
  const Batch<double> y =
      at.forward(Batch<double>::Zero(384, 1), none<double>(1));
  const std::complex<double> a(0, 0.025 * quantum_energy(1));
  const std::complex<double> turned = std::pow((1.0 - a) / (1.0 + a), 384);
  const Vector<double> ground = quantum_eigenstate(1);
  Batch<double> expected(28, 1);
  for (Index j = 0; j < 14; ++j) {
    expected(2 * j, 0) = ground(j) * turned.real();
    expected(2 * j + 1, 0) = ground(j) * turned.imag();
  }
  EXPECT_TRUE(Comparator(1e-11, 0)(y, expected));
}

TEST(QuantumDipole, LossesOfKnownStates) {
  const AnyProblem<double> box(problems::quantum_dipole()),
      accurate(problems::quantum_dipole({.accurate_loss = true}));
  const Vector<double> psi1 = quantum_observation(quantum_eigenstate(1));
  const Vector<double> psi2 = quantum_observation(quantum_eigenstate(2));
  const Vector<double> psi3 = quantum_observation(quantum_eigenstate(3));
  Batch<double> y(28, 3), t(28, 3);
  y << psi1, 0.6 * psi2 + 0.8 * psi3, psi3;
  t << psi2, 0.8 * psi2 + 0.6 * psi3, -psi3;
  Vector<double> loss(3), low(3), high(3), same(3);
  box.loss(y, t, loss);
  accurate.loss(y, t, same);
  quantum_level_loss<double>(2, y, t, low);
  quantum_level_loss<double>(3, y, t, high);
  const Comparator near(0, 1e-14);
  EXPECT_TRUE(near(loss, Eigen::Vector3d(1, 1 - 0.96 * 0.96, 0)));
  EXPECT_TRUE(near(same, loss));
  EXPECT_TRUE(near(low, Eigen::Vector3d(1, 0.04, 0)));
  EXPECT_TRUE(near(high, Eigen::Vector3d(0, 0.04, 0)));
}

TEST(QuantumDipole, LossGradientAgreesWithDifferences) {
  const AnyProblem<double> box(problems::quantum_dipole());
  const Batch<double> y = waves<double>(28, 4, 0.2) * 0.3;
  const Batch<double> t = waves<double>(28, 4, 1.1) * 0.4;
  Batch<double> g(28, 4);
  box.loss_gradient(y, t, g);
  for (Index i = 0; i < 4; ++i) {
    const auto f = [&](const Vector<double>& at) {
      Vector<double> value(1);
      box.loss(at, t.col(i), value);
      return value(0);
    };
    EXPECT_TRUE(
        Comparator(1e-7, 1e-9)(g.col(i), difference_gradient(f, y.col(i))));
  }
}

TEST(QuantumDipole, TheAccurateLossResolvesWhatTheOtherRoundsAway) {
  const AnyProblem<float> box(
      problems::quantum_dipole({.accurate_loss = true})),
      plain(problems::quantum_dipole());
  Batch<float> t = AnyProblem<double>(problems::quantum_dipole())
                       .sample(0, 1, kRng)
                       .y.cast<float>(),
               y = t;
  const double angle = 1e-5;
  y += float(angle) * quantum_observation(quantum_eigenstate(1)).cast<float>();
  Vector<double> loss(1), rough(1);
  box.loss(y, t, loss);
  plain.loss(y, t, rough);
  EXPECT_NEAR(loss(0) / (angle * angle), 1, 0.02);
  EXPECT_GT(std::abs(rough(0) - loss(0)), 10 * loss(0));
}

TEST(QuantumDipole, ProjectionTakesOutWhatNoControlActsOn) {
  const AnyProblem<double> box(problems::quantum_dipole());
  Physics at(box);
  const Batch<double> x = controls(384, 5, 0.3);
  const Batch<double> psi = at.linearize(x, none<double>(5));
  const Batch<double> raw = waves<double>(28, 5, 0.7);
  Batch<double> g = raw;
  box.project(psi, g);
  EXPECT_LE((psi.array() * g.array()).colwise().sum().abs().maxCoeff(), 1e-13);
  EXPECT_GT((raw - g).norm(), 0.05);
  EXPECT_TRUE(Comparator(1e-12, 0)(at.pullback(g), at.pullback(raw)));
}

TEST(QuantumDipole, TargetsAreUniformOnACircleOfStates) {
  const AnyProblem<double> box(problems::quantum_dipole());
  const auto s = box.sample(0, 1024, kRng);
  EXPECT_EQ(s.x.rows(), 0);
  const Vector<double> psi2 = quantum_observation(quantum_eigenstate(2));
  const Vector<double> psi3 = quantum_observation(quantum_eigenstate(3));
  const Vector<double> f1 = s.y.transpose() * psi2, f2 = s.y.transpose() * psi3;
  EXPECT_TRUE(
      Comparator(1e-14, 0)(s.y, psi2 * f1.transpose() + psi3 * f2.transpose()));
  EXPECT_TRUE(Comparator(1e-14, 0)(
      (f1.array().square() + f2.array().square()).matrix().eval(),
      Vector<double>::Ones(1024)));
  EXPECT_NEAR(f1.squaredNorm() / 1024, 0.5, 0.04);
  EXPECT_NEAR(f1.dot(f2) / 1024, 0, 0.04);
  EXPECT_NEAR(f1.mean(), 0, 0.08);
}

TEST(QuantumDipole, NoControlCannotReachTheThirdLevelAtFirstOrder) {
  const AnyProblem<double> box(problems::quantum_dipole());
  Physics at(box);
  const Batch<double> j =
      at.jacobian(Batch<double>::Zero(384, 1), none<double>(1));
  const Vector<double> psi3 = quantum_observation(quantum_eigenstate(3));
  EXPECT_LE((psi3.transpose() * at.matrix(j, 0)).norm(), 1e-12 * j.norm());
  EXPECT_GT(
      (quantum_observation(quantum_eigenstate(2)).transpose() * at.matrix(j, 0))
          .norm(),
      1e-3 * j.norm());
  EXPECT_GT(box.start().norm(), 1);
}

// An inverse power multiplies what is lost here.
TEST(QuantumDipole, JacobiansInFloatAreThoseOfDoubleRounded) {
  const Batch<float> x = controls(384, 21, 0.3).cast<float>();
  const AnyProblem<float> single(problems::quantum_dipole());
  const AnyProblem<double> box(problems::quantum_dipole());
  Batch<float> j(28 * 384, 21);
  Batch<double> exact(28 * 384, 21);
  Workspace work;
  single.jacobian(x, none<float>(21), j, work);
  box.jacobian(x.cast<double>(), none<double>(21), exact, work);
  EXPECT_TRUE(same_bits(j, Batch<float>(exact.cast<float>())));
}

TEST(QuantumDipole, TakesLittleMemory) {
  const AnyProblem<double> box(problems::quantum_dipole());
  const Batch<double> x = controls(384, 256, 0.1);
  Physics at(box);
  at.gradient(x, none<double>(256), waves<double>(28, 256, 0));
  EXPECT_LE(at.tape.bytes(), std::size_t{1} << 20);
  EXPECT_LE(at.work.bytes(), std::size_t{1} << 16);
  at.jacobian(x.leftCols(16), none<double>(16));
  EXPECT_LE(at.work.bytes(), std::size_t{1} << 16);
}

TEST(QuantumDipole, RejectsWrongSizes) {
  const AnyProblem<double> box(problems::quantum_dipole());
  Workspace work;
  Batch<double> x = Batch<double>::Zero(383, 2), y(28, 2);
  EXPECT_THROW(box.forward(x, none<double>(2), y, work), ContractError);
  EXPECT_THROW(quantum_eigenstate(0), ContractError);
}

}  // namespace
}  // namespace physinv::test
