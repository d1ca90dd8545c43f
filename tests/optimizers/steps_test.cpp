#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "optimizers/steps/rule.h"

namespace physinv {
namespace {

template <class T>
Vector<T> some_gradient(Index n, int t) {
  return Vector<T>::NullaryExpr(n, [=](Index i) {
    return static_cast<T>(std::sin(0.7 * double(i) + 1.1 * t) * (i + 1));
  });
}

template <class T>
class StepsTest : public testing::Test {
 protected:
  const double tol_ = sizeof(T) == 4 ? 2e-6 : 1e-14;
};
using Types = testing::Types<float, double>;
TYPED_TEST_SUITE(StepsTest, Types);

/// Turns a gradient and its own state into a step: x is updated in place.
template <class U, class T>
concept UpdateRule = requires(U u, VectorOut<T> x, VectorIn<T> gradient) {
  u.step(x, gradient);
};

static_assert(UpdateRule<Adam<float>, float>);
static_assert(UpdateRule<Sgd<double>, double>);
static_assert(UpdateRule<Adagrad<float>, float>);
static_assert(UpdateRule<Adadelta<float>, float>);
static_assert(UpdateRule<Rmsprop<float>, float>);

TYPED_TEST(StepsTest, AdamFollowsTheFormula) {
  using T = TypeParam;
  for (const bool before : {false, true}) {
    const Index n = 13;
    const AdamOptions o{.rate = 0.01, .eps_before_correction = before};
    Adam<T> adam(o);
    Vector<T> x = Vector<T>::Ones(n);
    Vector<double> y = Vector<double>::Ones(n), m = 0 * y, v = 0 * y;
    for (int t = 1; t <= 20; ++t) {
      const Vector<T> g = some_gradient<T>(n, t);
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
    const Vector<T> g = some_gradient<T>(5, t);
    sgd.step(x, g);
    u = 0.9 * u + g.template cast<double>();
    y -= 0.01 * u;
    EXPECT_LE((x.template cast<double>() - y).cwiseAbs().maxCoeff(),
              this->tol_ * 4 * t);
  }
}

/// Compares twenty steps of `rule` with `formula(g, x)` on each number, in
/// double.
template <class T, class Formula>
void expect_formula(const StepOptions& options, double tol, Formula make) {
  const Index n = 13;
  UpdateStep<T> step(options);
  Vector<T> x = Vector<T>::Ones(n);
  std::vector<double> y(static_cast<std::size_t>(n), 1.0);
  std::vector formulas(static_cast<std::size_t>(n), make());
  for (int t = 1; t <= 20; ++t) {
    const Vector<T> g = some_gradient<T>(n, t);
    step(x, g);
    for (Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      y[at] -= formulas[at](static_cast<double>(g(i)));
      EXPECT_NEAR(static_cast<double>(x(i)), y[at], tol * t);
    }
  }
}

TYPED_TEST(StepsTest, AdagradFollowsTheFormula) {
  expect_formula<TypeParam>(AdagradOptions{.rate = 0.1}, this->tol_, [] {
    return [a = 0.1](double g) mutable {
      a += g * g;
      return 0.1 * g / (std::sqrt(a) + 1e-7);
    };
  });
}

TYPED_TEST(StepsTest, RmspropFollowsTheFormula) {
  expect_formula<TypeParam>(RmspropOptions{.rate = 0.01}, this->tol_, [] {
    return [a = 0.0](double g) mutable {
      a = 0.9 * a + 0.1 * g * g;
      return 0.01 * g / (std::sqrt(a) + 1e-7);
    };
  });
}

TYPED_TEST(StepsTest, AdadeltaFollowsTheFormula) {
  expect_formula<TypeParam>(AdadeltaOptions{.rate = 0.1}, this->tol_, [] {
    return [a = 0.0, c = 0.0](double g) mutable {
      a = 0.95 * a + 0.05 * g * g;
      const double d = std::sqrt(c + 1e-7) / std::sqrt(a + 1e-7) * g;
      c = 0.95 * c + 0.05 * d * d;
      return 0.1 * d;
    };
  });
}

/// Equal numbers take equal steps wherever they are, also unaligned.
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
  expect_place_does_not_matter<T>([] { return Adagrad<T>(); });
  expect_place_does_not_matter<T>([] { return Adadelta<T>(); });
  expect_place_does_not_matter<T>([] { return Rmsprop<T>(); });
}

/// A step written over its gradient has the bits of one in place.
template <class T, class Rule>
void expect_same_beside(Rule make) {
  auto in_place = make(), beside = make();
  Vector<T> x = some_gradient<T>(13, 7), y = x;
  for (int t = 0; t < 5; ++t) {
    Vector<T> g = some_gradient<T>(13, t);
    const Vector<T> before = y;
    in_place.step(x, g);
    beside.step(y, g, g);
    EXPECT_TRUE((y.array() == before.array()).all());
    y.swap(g);
    EXPECT_TRUE((y.array() == x.array()).all());
  }
}

TYPED_TEST(StepsTest, WritesBesideWhatItWouldWriteInPlace) {
  using T = TypeParam;
  expect_same_beside<T>([] { return Adam<T>(); });
  expect_same_beside<T>([] { return Sgd<T>({.rate = 0.1, .momentum = 0.37}); });
  expect_same_beside<T>([] { return Adagrad<T>(); });
  expect_same_beside<T>([] { return Adadelta<T>(); });
  expect_same_beside<T>([] { return Rmsprop<T>(); });
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
  EXPECT_LE(descend<T>(Adagrad<T>({.rate = 0.5}), 500), 1e-2);
  EXPECT_LE(descend<T>(Adadelta<T>({.rate = 10}), 500), 5e-2);
  EXPECT_LE(descend<T>(Rmsprop<T>({.rate = 1e-3}), 3000), 1e-2);
  EXPECT_LE(
      descend<T>(Adam<T>({.rate = 0.05, .eps_before_correction = true}), 500),
      1e-2);
}

TYPED_TEST(StepsTest, ResetForgets) {
  using T = TypeParam;
  Adam<T> a({.rate = 0.1}), b({.rate = 0.1});
  Vector<T> x = Vector<T>::Ones(6), y = x;
  a.step(x, some_gradient<T>(6, 1));
  a.reset();
  x.setOnes();
  a.step(x, some_gradient<T>(6, 2));
  b.step(y, some_gradient<T>(6, 2));
  EXPECT_TRUE((x.array() == y.array()).all());
}

}  // namespace
}  // namespace physinv
