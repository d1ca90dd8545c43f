#include "problems/grid_poisson/grid_poisson.h"

#include "suite/core/any_problem.h"
#include "suite/linalg/decompositions.h"
#include "tests/problems/physics_checks.h"

namespace physinv::test {
namespace {

const Rng kRng = Rng::root("grid_poisson_test", 1);

TEST(GridPoisson, DerivativesAgreeWithDifferences) {
  const AnyProblem<double> grid(problems::grid_poisson());
  const auto s = grid.sample(0, 3, kRng);
  expect_derivatives(grid, s.x, s.given);
}

TEST(GridPoisson, TheOperatorIsSymmetricAndNegative) {
  const AnyProblem<double> grid(problems::grid_poisson());
  Physics at(grid);
  const Batch<double> j =
      at.jacobian(Batch<double>::Zero(64, 1), Batch<double>(0, 1));
  const Batch<double> l = at.matrix(j, 0);
  EXPECT_TRUE(same_bits(l, Batch<double>(l.transpose())));
  const Vector<double> lambda = linalg::symmetric_eigen(l).values;
  EXPECT_NEAR(lambda(0), -4 + 4 * std::cos(8 * M_PI / 9), 1e-12);
  EXPECT_NEAR(lambda(63), -4 + 4 * std::cos(M_PI / 9), 1e-12);
}

TEST(GridPoisson, AConstantFeelsOnlyTheBorder) {
  const AnyProblem<float> grid(problems::grid_poisson());
  Physics at(grid);
  const Batch<float> y =
      at.forward(Batch<float>::Ones(64, 1), Batch<float>(0, 1));
  for (Index i = 0; i < 8; ++i)
    for (Index j = 0; j < 8; ++j)
      EXPECT_EQ(y(8 * i + j, 0),
                -float((i == 0) + (i == 7) + (j == 0) + (j == 7)));
}

template <class T>
void check_independent() {
  const AnyProblem<T> grid(problems::grid_poisson());
  const auto s = grid.sample(0, 200, kRng).template cast<T>();
  expect_independent_samples<T>(grid, s.x, s.given);
  Workspace work;
  Batch<T> x(64, 200), one(64, 1);
  grid.invert(s.y, s.given, x, x, work);
  for (const Index i : {0, 63, 64, 199}) {
    grid.invert(s.y.col(i), s.given.col(i), one, one, work);
    EXPECT_TRUE(same_bits(one, Batch<T>(x.col(i))));
  }
}

TEST(GridPoisson, ASampleDoesNotDependOnItsBatch) {
  check_independent<float>();
  check_independent<double>();
}

template <class T>
void check_contained() {
  const AnyProblem<T> grid(problems::grid_poisson());
  const auto s = grid.sample(0, 19, kRng).template cast<T>();
  for (const T bad : {std::numeric_limits<T>::quiet_NaN(),
                      std::numeric_limits<T>::infinity()}) {
    Batch<T> x = s.x;
    x(13, 7) = bad;
    expect_contained<T>(grid, s.x, s.given, x, 7);
  }
}

TEST(GridPoisson, WhatIsNotFiniteStaysInItsColumn) {
  check_contained<float>();
  check_contained<double>();
}

template <class T>
void check_inverse(double near) {
  const AnyProblem<T> grid(problems::grid_poisson());
  const auto s = grid.sample(0, 70, kRng).template cast<T>();
  Workspace work;
  Batch<T> x(64, 70);
  grid.invert(s.y, s.given, Batch<T>::Zero(64, 70), x, work);
  EXPECT_TRUE(Comparator(near, 0)(x, s.x));
}

TEST(GridPoisson, InvertsExactly) {
  check_inverse<double>(1e-13);
  check_inverse<float>(1e-5);
}

TEST(GridPoisson, PotentialsAreStandardizedAndSmooth) {
  const AnyProblem<double> grid(problems::grid_poisson());
  const auto s = grid.sample(0, 4096, kRng);
  EXPECT_LE(s.x.colwise().mean().cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_TRUE(
      Comparator(1e-13, 0)(s.x.colwise().squaredNorm().transpose().eval() / 64,
                           Vector<double>::Ones(4096)));
  // Half the square of a source is what predicting nothing costs.
  const Vector<double> loss = s.y.colwise().squaredNorm().transpose() / 2;
  EXPECT_NEAR(loss.mean(), 113, 3);
  EXPECT_NEAR(std::sqrt(2 * loss.mean() / 64), 1.88, 0.03);
  EXPECT_NEAR(s.y.colwise().mean().cwiseAbs().mean(), 0.16, 0.01);
}

TEST(GridPoisson, NoNoiseIsNoPotential) {
  EXPECT_EQ(poisson_potential(Vector<double>::Zero(128)).norm(), 0);
  EXPECT_THROW(poisson_potential(Vector<double>::Zero(64)), ContractError);
}

}  // namespace
}  // namespace physinv::test
