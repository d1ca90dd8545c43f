#include <gtest/gtest.h>

#include <cmath>

#include "optimizers/steps/adam.h"
#include "optimizers/steps/sgd.h"
#include "suite/core/objective.h"

namespace physinv {
namespace {

template <class T>
class StepsTest : public testing::Test {
 protected:
  const double tol_ = sizeof(T) == 4 ? 2e-6 : 1e-14;
  static Vector<T> gradient(Index n, int t) {
    return Vector<T>::NullaryExpr(n, [=](Index i) {
      return static_cast<T>(std::sin(0.7 * double(i) + 1.1 * t) * (i + 1));
    });
  }
};
using Types = testing::Types<float, double>;
TYPED_TEST_SUITE(StepsTest, Types);

static_assert(UpdateRule<Adam<float>, float>);
static_assert(UpdateRule<Sgd<double>, double>);

TYPED_TEST(StepsTest, AdamFollowsTheFormula) {
  using T = TypeParam;
  for (const bool before : {false, true}) {
    const Index n = 13;
    const AdamOptions o{.rate = 0.01, .eps_before_correction = before};
    Adam<T> adam(o);
    Vector<T> x = Vector<T>::Ones(n);
    Vector<double> y = Vector<double>::Ones(n), m = 0 * y, v = 0 * y;
    for (int t = 1; t <= 20; ++t) {
      const Vector<T> g = this->gradient(n, t);
      adam.step(x, g);
      for (Index i = 0; i < n; ++i) {
        const auto gi = static_cast<double>(g(i));
        m(i) = o.beta1 * m(i) + (1 - o.beta1) * gi;
        v(i) = o.beta2 * v(i) + (1 - o.beta2) * gi * gi;
        const double c1 = 1 - std::pow(o.beta1, t);
        const double c2 = 1 - std::pow(o.beta2, t);
        y(i) -= before ? o.rate * std::sqrt(c2) / c1 * m(i) /
                             (std::sqrt(v(i)) + o.eps)
                       : o.rate * (m(i) / c1) / (std::sqrt(v(i) / c2) + o.eps);
      }
      EXPECT_LE((x.template cast<double>() - y).cwiseAbs().maxCoeff(),
                this->tol_ * t);
    }
  }
}

TYPED_TEST(StepsTest, SgdFollowsTheFormula) {
  using T = TypeParam;
  Sgd<T> sgd({.rate = 0.01, .momentum = 0.9});
  Vector<T> x = Vector<T>::Ones(5);
  Vector<double> y = Vector<double>::Ones(5), u = 0 * y;
  for (int t = 1; t <= 10; ++t) {
    const Vector<T> g = this->gradient(5, t);
    sgd.step(x, g);
    u = 0.9 * u + g.template cast<double>();
    y -= 0.01 * u;
    EXPECT_LE((x.template cast<double>() - y).cwiseAbs().maxCoeff(),
              this->tol_ * 4 * t);
  }
}

/// Equal numbers take equal steps wherever they stand, also unaligned.
template <class T, class Rule>
void expect_place_does_not_matter(Rule make) {
  for (const Index offset : {0, 1, 3}) {
    Vector<T> x = Vector<T>::Constant(41 + offset, T(0.3));
    Vector<T> g = Vector<T>::Constant(41 + offset, T(-0.7123));
    auto rule = make();
    for (int t = 0; t < 5; ++t) rule.step(x.tail(41), g.tail(41));
    EXPECT_TRUE((x.tail(41).array() == x(offset)).all());
  }
}

TYPED_TEST(StepsTest, TheTailHasTheBitsOfTheBody) {
  using T = TypeParam;
  expect_place_does_not_matter<T>([] { return Adam<T>(); });
  expect_place_does_not_matter<T>(
      [] { return Sgd<T>({.rate = 0.1, .momentum = 0.37}); });
}

template <class T, class Rule>
double descend(Rule rule, int steps) {
  const Vector<T> target = Vector<T>::LinSpaced(11, T(-1), T(2));
  Vector<T> x = Vector<T>::Zero(11);
  for (int t = 0; t < steps; ++t) {
    Vector<T> g = x - target;
    g.array() *= Vector<T>::LinSpaced(11, T(0.5), T(3)).array();
    rule.step(x, g);
  }
  return static_cast<double>((x - target).norm());
}

TYPED_TEST(StepsTest, EveryRuleDescends) {
  using T = TypeParam;
  EXPECT_LE(descend<T>(Sgd<T>({.rate = 0.1}), 200), 1e-3);
  EXPECT_LE(descend<T>(Sgd<T>({.rate = 0.05, .momentum = 0.8}), 200), 1e-3);
  EXPECT_LE(descend<T>(Adam<T>({.rate = 0.05}), 500), 1e-2);
  EXPECT_LE(
      descend<T>(Adam<T>({.rate = 0.05, .eps_before_correction = true}), 500),
      1e-2);
}

TYPED_TEST(StepsTest, ResetForgets) {
  using T = TypeParam;
  Adam<T> a({.rate = 0.1}), b({.rate = 0.1});
  Vector<T> x = Vector<T>::Ones(6), y = x;
  a.step(x, this->gradient(6, 1));
  a.reset();
  x.setOnes();
  a.step(x, this->gradient(6, 2));
  b.step(y, this->gradient(6, 2));
  EXPECT_TRUE((x.array() == y.array()).all());
}

}  // namespace
}  // namespace physinv
