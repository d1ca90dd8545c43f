#include "problems/scaled_output/scaled_output.h"

#include "suite/core/any_problem.h"
#include "tests/problems/physics_checks.h"

namespace physinv::test {
namespace {

const Rng kRng = Rng::root("scaled_output_test", 1);

TEST(ScaledOutput, DerivativesAgreeWithDifferences) {
  for (const double gamma : {1.0, 0.1, 0.01, 1e-12}) {
    const AnyProblem<double> fit(problems::scaled_output({.gamma = gamma}));
    const auto s = fit.sample(0, 5, kRng);
    const Batch<double> x = waves<double>(2, 5, 0.3);
    expect_derivatives(fit, x, s.given, 1e-8);
    Physics at(fit);
    EXPECT_EQ(at.matrix(at.jacobian(x, s.given), 2)(1, 1), gamma);
  }
}

template <class T>
void check_columns() {
  const AnyProblem<T> fit(problems::scaled_output());
  const auto s = fit.sample(0, 37, kRng).template cast<T>();
  expect_independent_samples<T>(fit, s.x, s.given);
  for (const Index row : {0, 1}) {
    Batch<T> x = s.x;
    x(row, 7) = std::numeric_limits<T>::quiet_NaN();
    expect_contained<T>(fit, s.x, s.given, x, 7);
  }
}

TEST(ScaledOutput, ColumnsAreIndependent) {
  check_columns<float>();
  check_columns<double>();
}

TEST(ScaledOutput, PointsAreUniformAndSolutionsExact) {
  const AnyProblem<double> fit(problems::scaled_output({.gamma = 0.01}));
  const auto s = fit.sample(0, 8192, kRng);
  EXPECT_GE(s.given.minCoeff(), -1);
  EXPECT_LT(s.given.maxCoeff(), 1);
  EXPECT_NEAR(s.given.mean(), 0, 0.02);
  Physics at(fit);
  EXPECT_TRUE(Comparator(1e-14, 0)(at.forward(s.x, s.given), s.y));
  // What an output of zero costs: 1/2 + sin 18 / 72 - sin 12 / 48.
  Vector<double> loss(8192);
  fit.loss(Batch<double>::Zero(2, 8192), s.y, loss);
  EXPECT_NEAR(loss.mean(), 0.5007, 0.01);
}

TEST(ScaledOutput, RejectsWhatItCannotDo) {
  EXPECT_THROW(AnyProblem<double>(problems::scaled_output({.gamma = 0})),
               ContractError);
  const AnyProblem<double> fit(problems::scaled_output());
  Workspace work;
  Batch<double> x = Batch<double>::Zero(3, 2), given(1, 2), y(2, 2);
  EXPECT_THROW(fit.forward(x, given, y, work), ContractError);
}

}  // namespace
}  // namespace physinv::test
