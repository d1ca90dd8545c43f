// What every registered problem promises (suite/core/problem.h).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "suite/harness/study.h"
#include "tests/contract/problem_bench.h"
#include "tests/support/bits.h"
#include "tests/support/gradient_check.h"
#include "tests/support/registered.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

constexpr Index kCount = 37;  // no multiple of any lane width

class ProblemContract : public testing::TestWithParam<ExperimentPtr> {
 protected:
  const ProblemRecipe& recipe() const { return GetParam()->problem; }
  Samples<double> labelled(Index count = kCount) const {
    return recipe().make<double>()->sample_labelled(0, count, rng_);
  }
  bool provides(Needs n) const { return contains(recipe().provided, n); }
  /// Of differences: a flow has kinks 1e-5 apart.
  double step() const { return recipe().name == "navier_stokes" ? 2e-8 : 1e-6; }

  template <class F>
  void in_both(F&& check) const {
    check(float{}), check(double{});
  }

  const Rng rng_ = Rng::root("problem_contract", 1);
};

TEST_P(ProblemContract, ShapesAndAbilitiesAreAsDeclared) {
  in_both([&](auto t) {
    using T = decltype(t);
    const auto p = recipe().template make<T>();
    const Shape s = p->shape();
    EXPECT_GT(s.unknowns, 0);
    EXPECT_GT(s.observations, 0);
    EXPECT_GE(s.given, 0);
    EXPECT_EQ(p->start().size(), s.unknowns);
    EXPECT_TRUE(p->start().allFinite());
    EXPECT_GT(p->operations(), 0);
    EXPECT_EQ(dynamic_cast<Vjp<T>*>(p.get()) != nullptr, provides(Needs::vjp));
    EXPECT_EQ(dynamic_cast<Jacobian<T>*>(p.get()) != nullptr,
              provides(Needs::jacobian));
    EXPECT_EQ(dynamic_cast<Inverse<T>*>(p.get()) != nullptr,
              provides(Needs::inverse));
    EXPECT_EQ(dynamic_cast<Hessian<T>*>(p.get()) != nullptr,
              provides(Needs::hessian));
    EXPECT_EQ(dynamic_cast<Jvp<T>*>(p.get()) != nullptr, provides(Needs::jvp));
    EXPECT_EQ(dynamic_cast<PullbackTangent<T>*>(p.get()) != nullptr,
              provides(Needs::pullback_tangent));
    for (const auto& set :
         {recipe().make<double>()->sample(0, 5, rng_), labelled(5)}) {
      EXPECT_EQ(set.y.rows(), s.observations);
      EXPECT_EQ(set.given.rows(), s.given);
      EXPECT_EQ(set.y.cols(), 5);
      EXPECT_TRUE(set.x.rows() == s.unknowns || set.x.rows() == 0);
      EXPECT_TRUE(set.x.allFinite() && set.y.allFinite() &&
                  set.given.allFinite());
    }
    EXPECT_EQ(labelled(5).x.rows(), s.unknowns);
  });
}

TEST_P(ProblemContract, SamplesSatisfyTheModel) {
  ProblemBench<double> b(recipe());
  const auto l = labelled();
  EXPECT_TRUE(same_bits(b.forward(l.x, l.given), l.y));
  const auto s = b.problem->sample(0, kCount, rng_);
  // The signals above with hidden noise: what explains them was shown there.
  const bool hidden = same_bits(s.x, l.x) && same_bits(s.y, l.y);
  if (s.x.rows() > 0 && !hidden) {
    EXPECT_TRUE(Comparator(1e-10, 0)(b.forward(s.x, s.given), s.y));
  }
}

TEST_P(ProblemContract, SamplesRepeatAndSmallSetsArePrefixes) {
  const auto expect_part =
      [](const Samples<double>& all, const Samples<double>& part, Index first) {
        const Index n = part.count();
        const auto cut = [&](const Batch<double>& b) {
          return Batch<double>(b.middleCols(first, n));
        };
        EXPECT_TRUE(same_bits(cut(all.x), part.x));
        EXPECT_TRUE(same_bits(cut(all.y), part.y));
        EXPECT_TRUE(same_bits(cut(all.given), part.given));
      };
  const auto d = recipe().make<double>();
  const Rng other = Rng::root("problem_contract", 2);
  const auto all = d->sample(0, kCount, rng_);
  expect_part(all, d->sample(0, 4, rng_), 0);
  expect_part(all, d->sample(9, 11, rng_), 9);
  EXPECT_NE(content_hash(all), content_hash(d->sample(0, kCount, other)));
  const auto pairs = labelled();
  expect_part(pairs, d->sample_labelled(0, 4, rng_), 0);
  expect_part(pairs, d->sample_labelled(9, 11, rng_), 9);
}

TEST_P(ProblemContract, PullbackAgreesWithCentralDifferences) {
  if (!provides(Needs::vjp)) GTEST_SKIP() << "has no vjp";
  ProblemBench<double> b(recipe());
  // Each unknown takes two solves.
  const Index unknowns = b.problem->shape().unknowns;
  if (b.problem->operations() * double(unknowns) > 4e10)
    GTEST_SKIP() << "looked at on a smaller grid";
  const Index count = unknowns > 2000 ? 2 : unknowns > 500 ? 4 : 24;
  const auto l = labelled(count);
  const Batch<double> y_bar = directions<double>(l.y.rows(), count, 0.4);
  const Batch<double> x_bar = b.pull(l.x, l.given, y_bar);
  EXPECT_TRUE(same_bits(b.y, l.y)) << "linearize differs from forward";
  Index checked = 0, sloping = 0;
  for (Index i = 0; i < count; ++i) {
    const auto by_differences = [&](double h) {
      return b.difference(l.x.col(i), l.given.col(i), y_bar.col(i), h);
    };
    Vector<double> g;
    if (!smooth_derivative(by_differences, g, step())) continue;
    ++checked;
    sloping += x_bar.col(i).norm() > 0;
    EXPECT_TRUE(Comparator(1e-5, 1e-7)(x_bar.col(i), g)) << "sample " << i;
  }
  EXPECT_GE(checked, count / 2);
  EXPECT_GE(sloping, count / 4);
}

TEST_P(ProblemContract, PullbackIsTheAdjointOfTheDirectionalDerivative) {
  if (!provides(Needs::vjp)) GTEST_SKIP() << "has no vjp";
  ProblemBench<double> b(recipe());
  const auto l = labelled(24);
  const Batch<double> y_bar = directions<double>(l.y.rows(), 24, 2.4);
  const Batch<double> v = directions<double>(l.x.rows(), 24, 0.7);
  const Batch<double> x_bar = b.pull(l.x, l.given, y_bar);
  Index checked = 0;
  for (Index i = 0; i < 24; ++i) {
    const Batch<double> given = l.given.col(i);
    const auto f = [&](const Vector<double>& x) {
      return Vector<double>(b.forward(x, given).col(0));
    };
    Vector<double> jv;
    if (!smooth_derivative(
            [&](double h) {
              return difference_along(f, l.x.col(i), v.col(i), h);
            },
            jv,
            step()))
      continue;
    ++checked;
    EXPECT_NEAR(x_bar.col(i).dot(v.col(i)),
                y_bar.col(i).dot(jv),
                1e-5 * y_bar.col(i).norm() * jv.norm() + 1e-7);
  }
  EXPECT_GE(checked, 12);
}

TEST_P(ProblemContract, PushforwardIsTheTransposeOfPullback) {
  if (!provides(Needs::vjp | Needs::jvp)) GTEST_SKIP() << "has no jvp";
  in_both([&](auto t) {
    using T = decltype(t);
    ProblemBench<T> b(recipe());
    const auto& jvp = dynamic_cast<const Jvp<T>&>(*b.problem);
    const auto l = labelled().template cast<T>();
    const Batch<T> x_dot = directions<T>(l.x.rows(), kCount, 0.7);
    const Batch<T> y_bar = directions<T>(l.y.rows(), kCount, 0.4);
    const Batch<T> x_bar = b.pull(l.x, l.given, y_bar);
    Batch<T> y_dot(l.y.rows(), kCount);
    jvp.pushforward(b.tape, x_dot, y_dot, b.work);
    for (Index i = 0; i < kCount; ++i)
      EXPECT_NEAR(double(y_dot.col(i).dot(y_bar.col(i))),
                  double(x_bar.col(i).dot(x_dot.col(i))),
                  Tolerance<T>::relative *
                      double(y_dot.col(i).norm() * y_bar.col(i).norm()));
    // A problem with this has half the squared error as its loss.
    Batch<T> slope(y_dot), moved(y_dot);
    b.problem->loss_gradient(l.y, l.y, slope);
    b.problem->loss_gradient(l.y + y_dot, l.y, moved);
    EXPECT_TRUE(
        Comparator(Tolerance<T>::relative, 1e-3 * Tolerance<T>::relative)(
            moved - slope, (l.y + y_dot) - l.y));
  });
}

TEST_P(ProblemContract, PullbackTangentAgreesWithCentralDifferences) {
  if (!provides(Needs::vjp | Needs::pullback_tangent))
    GTEST_SKIP() << "has no tangent of the pullback";
  ProblemBench<double> b(recipe());
  const auto& tangent =
      dynamic_cast<const PullbackTangent<double>&>(*b.problem);
  const auto l = labelled(24);
  const Batch<double> x_dot = directions<double>(l.x.rows(), 24, 0.7);
  const Batch<double> y_bar = directions<double>(l.y.rows(), 24, 0.4);
  const Batch<double> y_bar_dot = directions<double>(l.y.rows(), 24, 1.3);
  Batch<double> x_bar_dot(l.x.rows(), 24);
  b.pull(l.x, l.given, y_bar);
  tangent.pullback_tangent(
      b.tape, {x_dot, y_bar, y_bar_dot}, x_bar_dot, b.work);
  Index checked = 0;
  for (Index i = 0; i < 24; ++i) {
    const Batch<double> given = l.given.col(i);
    const auto difference = [&](double h) {
      const auto at = [&](double step) {
        return b.pull(l.x.col(i) + step * x_dot.col(i),
                      given,
                      y_bar.col(i) + step * y_bar_dot.col(i));
      };
      return Vector<double>((at(h) - at(-h)).col(0) / (2 * h));
    };
    Vector<double> d;
    if (!smooth_derivative(difference, d)) continue;
    ++checked;
    EXPECT_TRUE(Comparator(1e-5, 1e-7)(x_bar_dot.col(i), d)) << "sample " << i;
  }
  EXPECT_GE(checked, 12);
}

TEST_P(ProblemContract, JacobianAgreesWithPullback) {
  if (!provides(Needs::vjp | Needs::jacobian))
    GTEST_SKIP() << "has no vjp or no Jacobian";
  in_both([&](auto t) {
    using T = decltype(t);
    ProblemBench<T> b(recipe());
    const auto l = labelled().template cast<T>();
    const Index m = l.y.rows(), d = l.x.rows();
    const Batch<T> j = b.jacobian(l.x, l.given);
    const Batch<T> y_bar = directions<T>(m, kCount, 0.4);
    const Batch<T> x_bar = b.pull(l.x, l.given, y_bar);
    for (Index i = 0; i < kCount; ++i) {
      const Eigen::Map<const Batch<T>> ji(j.col(i).data(), m, d);
      const double scale = static_cast<double>(ji.cwiseAbs().maxCoeff());
      EXPECT_TRUE(Comparator(0, Tolerance<T>::relative * scale)(
          x_bar.col(i), ji.transpose() * y_bar.col(i)));
    }
  });
}

TEST_P(ProblemContract, HessianIsSymmetricAndTheGradientsDerivative) {
  if (!provides(Needs::vjp | Needs::hessian)) GTEST_SKIP() << "has no Hessian";
  ProblemBench<double> b(recipe());
  const auto l = labelled(12);
  const Batch<double> target = l.y + directions<double>(l.y.rows(), 12, 0.3);
  const Index d = l.x.rows();
  Batch<double> h(d * d, 12);
  dynamic_cast<const Hessian<double>&>(*b.problem)
      .hessian({l.x, l.given}, target, h, b.work);
  for (Index i = 0; i < 12; ++i) {
    const Batch<double> given = l.given.col(i);
    const auto gradient = [&](const Vector<double>& x) {
      Batch<double> y_bar(l.y.rows(), 1);
      b.problem->loss_gradient(b.forward(x, given), target.col(i), y_bar);
      return Vector<double>(b.pull(x, given, y_bar));
    };
    const Eigen::Map<const Batch<double>> hi(h.col(i).data(), d, d);
    EXPECT_TRUE(same_bits(Batch<double>(hi), Batch<double>(hi.transpose())));
    for (Index j = 0; j < d; ++j)
      EXPECT_TRUE(Comparator(1e-6, 1e-9)(
          hi.col(j),
          difference_along(
              gradient, l.x.col(i), Vector<double>::Unit(d, j), 1e-6)))
          << "sample " << i << ", unknown " << j;
  }
}

TEST_P(ProblemContract, InverseLowersTheLossAndColumnsAreIndependent) {
  if (!provides(Needs::inverse)) GTEST_SKIP() << "has no inverse";
  in_both([&](auto t) {
    using T = decltype(t);
    ProblemBench<T> b(recipe());
    const auto& inverse = dynamic_cast<const Inverse<T>&>(*b.problem);
    const auto l = labelled().template cast<T>();
    Batch<T> guess = l.x + directions<T>(l.x.rows(), kCount, 0.3);
    // An estimate that leaves small scales out, good from afar.
    if (recipe().name == "marker_flow")
      guess.colwise() = b.problem->start().template cast<T>();
    Batch<T> x(l.x.rows(), kCount), one(l.x.rows(), 1);
    inverse.invert({guess, l.given}, l.y, x, b.work);
    Vector<double> before(kCount), after(kCount);
    b.problem->loss(b.forward(guess, l.given), l.y, before);
    // Near an extremum of a sine as flat as the line the limit lets a step
    // overshoot; its direction is still that of descent.
    const T part = GetParam()->name == "sip/sine-xi1-gamma1" ? T(0.1) : T(1);
    const Batch<T> there = part == 1 ? x : Batch<T>(guess + part * (x - guess));
    b.problem->loss(b.forward(there, l.given), l.y, after);
    for (Index i = 0; i < kCount; ++i) {
      EXPECT_LT(after(i), before(i)) << "sample " << i;
      inverse.invert({guess.col(i), l.given.col(i)}, l.y.col(i), one, b.work);
      EXPECT_TRUE(same_bits(one, Batch<T>(x.col(i))));
    }
  });
}

TEST_P(ProblemContract, LossGradientAgreesWithCentralDifferences) {
  const auto p = recipe().make<double>();
  const auto l = labelled(6);
  const Batch<double> y = l.y + directions<double>(l.y.rows(), 6, 0.3);
  Batch<double> y_bar(l.y.rows(), 6);
  p->loss_gradient(y, l.y, y_bar);
  for (Index i = 0; i < 6; ++i) {
    const auto loss = [&](const Vector<double>& at) {
      Vector<double> value(1);
      p->loss(at, l.y.col(i), value);
      return value(0);
    };
    EXPECT_TRUE(Comparator(1e-6, 1e-8)(y_bar.col(i),
                                       difference_gradient(loss, y.col(i))));
  }
  Vector<double> zero(6);
  p->loss(l.y, l.y, zero);
  // A loss of overlaps, 1 - |<t, y>|^2, rounds.
  EXPECT_LE(zero.cwiseAbs().maxCoeff(), 1e-13);
}

TEST_P(ProblemContract, BatchesEqualTheirColumnsInAnyOrderBitwise) {
  in_both([&](auto t) {
    using T = decltype(t);
    Threads threads(3);
    ProblemBench<T> b(recipe()), threaded(recipe(), &threads);
    const auto l = labelled().template cast<T>();
    const Batch<T> y_bar = directions<T>(l.y.rows(), kCount, 0.4);
    const Batch<T> y = b.forward(l.x, l.given);
    EXPECT_TRUE(same_bits(threaded.forward(l.x, l.given), y));
    Batch<T> x_bar, j;
    if (b.vjp != nullptr) {
      x_bar = b.pull(l.x, l.given, y_bar);
      EXPECT_TRUE(same_bits(b.y, y));
      EXPECT_TRUE(same_bits(threaded.pull(l.x, l.given, y_bar), x_bar));
    }
    if (b.jac != nullptr) {
      j = b.jacobian(l.x, l.given);
      EXPECT_TRUE(same_bits(threaded.jacobian(l.x, l.given), j));
    }
    std::vector<std::vector<Index>> subsets;
    for (Index i = 0; i < kCount; ++i) subsets.push_back({i});
    subsets.push_back({5, 3, 36, 0, 17, 2, 11, 9, 30});
    subsets.emplace_back(kCount);
    std::iota(subsets.back().rbegin(), subsets.back().rend(), Index{0});
    for (const auto& some : subsets) {
      const auto of = [&](const Batch<T>& all) {
        return Batch<T>(all(Eigen::all, some));
      };
      EXPECT_TRUE(same_bits(b.forward(of(l.x), of(l.given)), of(y)));
      if (b.vjp != nullptr) {
        EXPECT_TRUE(
            same_bits(b.pull(of(l.x), of(l.given), of(y_bar)), of(x_bar)));
      }
      // Jacobians of each sample alone take a minute where simulations do.
      const bool quick = some.size() > 1 || b.problem->operations() < 1e6;
      if (b.jac != nullptr && quick) {
        EXPECT_TRUE(same_bits(b.jacobian(of(l.x), of(l.given)), of(j)));
      }
    }
  });
}

TEST_P(ProblemContract, ReadsAndWritesBlocksOfLargerMatrices) {
  in_both([&](auto t) {
    using T = decltype(t);
    ProblemBench<T> b(recipe());
    const auto l = labelled(20).template cast<T>();
    const T nan = std::numeric_limits<T>::quiet_NaN();
    Batch<T> x = Batch<T>::Constant(l.x.rows() + 3, 30, nan);
    Batch<T> given = Batch<T>::Constant(l.given.rows() + 2, 25, nan);
    Batch<T> out = Batch<T>::Constant(l.y.rows() + 5, 30, T(-3));
    x.block(1, 4, l.x.rows(), 20) = l.x;
    given.block(2, 3, l.given.rows(), 20) = l.given;
    auto y = out.block(2, 6, l.y.rows(), 20);
    b.problem->forward(
        {x.block(1, 4, l.x.rows(), 20), given.block(2, 3, l.given.rows(), 20)},
        y,
        b.work);
    EXPECT_TRUE(same_bits(Batch<T>(y), b.forward(l.x, l.given)));
    y.setConstant(T(-3));
    EXPECT_TRUE((out.array() == T(-3)).all());
  });
}

TEST_P(ProblemContract, ADivergedSampleDisturbsNoOther) {
  in_both([&](auto t) {
    using T = decltype(t);
    ProblemBench<T> b(recipe());
    const auto l = labelled().template cast<T>();
    const Batch<T> y_bar = directions<T>(l.y.rows(), kCount, 0.4);
    Batch<T> expected = b.forward(l.x, l.given), x = l.x;
    x.col(7).setConstant(std::numeric_limits<T>::quiet_NaN());
    Batch<T> y = b.forward(x, l.given);
    EXPECT_FALSE(y.col(7).allFinite());
    y.col(7) = expected.col(7);
    EXPECT_TRUE(same_bits(y, expected));
    if (b.vjp == nullptr) return;
    expected = b.pull(l.x, l.given, y_bar);
    EXPECT_TRUE(expected.allFinite());
    Batch<T> x_bar = b.pull(x, l.given, y_bar);
    EXPECT_FALSE(x_bar.col(7).allFinite());
    x_bar.col(7) = expected.col(7);
    EXPECT_TRUE(same_bits(x_bar, expected));
  });
}

TEST_P(ProblemContract, RepeatsItselfAndTakesNoMoreMemory) {
  in_both([&](auto t) {
    using T = decltype(t);
    ProblemBench<T> b(recipe());
    const auto l = labelled().template cast<T>();
    const Batch<T> y_bar = directions<T>(l.y.rows(), kCount, 0.4);
    const auto all = [&] {
      Batch<T> y = b.forward(l.x, l.given);
      if (b.vjp == nullptr) return y;
      Batch<T> both(y.rows() + l.x.rows(), kCount);
      both << y, b.pull(l.x, l.given, y_bar);
      return both;
    };
    const Batch<T> first = all();
    EXPECT_TRUE(first.allFinite());
    const std::size_t bytes = b.tape.bytes() + b.work.bytes();
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(same_bits(all(), first));
    EXPECT_EQ(b.tape.bytes() + b.work.bytes(), bytes);
  });
}

TEST_P(ProblemContract, FloatAgreesWithDouble) {
  ProblemBench<float> f(recipe());
  const auto l = labelled(128);
  // The same inputs for both: rounding may move a sample across a kink.
  const auto rounded = l.cast<float>();
  const auto exact = rounded.cast<double>();
  ProblemBench<double> d(recipe());
  const Batch<double> y = d.forward(exact.x, exact.given);
  const Batch<double> seen = f.forward(rounded.x, rounded.given).cast<double>();
  Index close = 0;
  for (Index i = 0; i < 128; ++i) {
    close += (seen.col(i) - y.col(i)).cwiseAbs().maxCoeff() <=
             1e-3 * (1 + y.col(i).cwiseAbs().maxCoeff());
  }
  EXPECT_GE(close, 122);
}

/// Of a study, which varies an option; the problem's own tests look at it.
bool takes_long(const Experiment& e) {
  constexpr double kManyOperations = 1e6;
  return studies().contains(e.name) &&
         e.problem.make<double>()->operations() > kManyOperations;
}

/// One experiment of each problem and setting.
std::vector<ExperimentPtr> distinct_problems() {
  std::vector<ExperimentPtr> all;
  std::set<std::pair<std::string, Options>> seen;
  for (const auto& e : registry().experiments())
    if (seen.emplace(e->problem.name, e->problem.options).second &&
        !takes_long(*e))
      all.push_back(e);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Registered,
                         ProblemContract,
                         testing::ValuesIn(distinct_problems()),
                         ExperimentName());

TEST(Registered, IsValidAndNotEmpty) {
  EXPECT_FALSE(registry().experiments().empty());
  EXPECT_NO_THROW(registry().validate());
}

}  // namespace
}  // namespace physinv::test
