#include "optimizers/bfgs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "optimizers/steps/bfgs_update.h"
#include "suite/core/check.h"
#include "tests/optimizers/solver_checks.h"
#include "tests/support/gradient_check.h"
#include "tests/support/jpo_entries.h"
#include "tests/support/run_reference.h"

namespace physinv {
namespace {

using test::Billiards;
using test::ClosedForm;
using test::single;
using test::starts;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
const std::string kId = "jpo-billiards";

template <class F>
Bfgs solve(F&& objective, BatchIn<double> x0, BfgsOptions options = {}) {
  Bfgs solver(options);
  drive(solver, objective, x0);
  return solver;
}

TEST(BfgsReference, TestFunctions) {
  test::check_entries_named(
      kId, "bfgs_test_functions", test::check_test_functions);
}

TEST(BfgsReference, Billiards) {
  test::check_entries_named(kId, "bfgs", [](const test::Json& entry) {
    for (const test::Json& stored : entry.at("runs")) {
      SCOPED_TRACE(stored.at("ball").dump());
      const Vector<double> ball = test::vector(stored.at("ball"), 2);
      const auto run = test::record_bfgs(
          Billiards{ball}, test::vector(stored.at("x0"), 2), stored.at("gtol"));
      test::expect_run(entry, stored, run, 1);
      // The loss of every miss: the ball stays where it is.
      EXPECT_NEAR(0.5 * (ball - Eigen::Vector2d(2, 0.5)).squaredNorm(),
                  test::number(stored.at("plateau_loss")),
                  1e-12);
    }
  });
}

TEST(Bfgs, TestFunctionsHaveTheirGradients) {
  const Vector<double> x = (Vector<double>(3) << 0.3, -0.7, 1.1).finished();
  for (const char* name : {"rosenbrock", "wavy", "well", "rough", "abs"}) {
    Vector<double> g, ignored;
    test::closed_form(name, x, g);
    const auto check = test::difference_gradient(
        [&](const Vector<double>& at) {
          return test::closed_form(name, at, ignored);
        },
        x);
    EXPECT_TRUE(test::Comparator(1e-7, 0)(g, check)) << name;
  }
}

TEST(Bfgs, BatchEqualsSoloRunsAndPermutationsBitwise) {
  for (const Index d : {1, 2, 3, 7})
    for (const char* name : {"wavy", "rough", "rosenbrock"})
      test::expect_independent_problems<Bfgs>(
          name, starts(d, 37), BfgsOptions{});
}

TEST(Bfgs, FinishedProblemsSaveEvaluations) {
  const Bfgs all = solve(ClosedForm{"rosenbrock"}, starts(2, 20));
  EXPECT_GT(all.skipped_evaluations(), 0U);
}

TEST(Bfgs, ObserverSeesEveryIterateOnce) {
  const Index n = 12;
  std::vector<Index> seen(static_cast<std::size_t>(n), 0);
  std::vector<double> last(static_cast<std::size_t>(n), kInf);
  Bfgs solver;
  drive(solver, ClosedForm{"wavy"}, starts(2, n), [&](const Bfgs& b) {
    for (const Index i : b.accepted()) {
      const auto at = static_cast<std::size_t>(i);
      EXPECT_EQ(b.iterations()[at], seen[at]++);
      EXPECT_LE(b.loss()(i), last[at]);
      last[at] = b.loss()(i);
      Vector<double> g;
      EXPECT_EQ(test::closed_form("wavy", b.x().col(i), g), b.loss()(i));
    }
  });
  for (std::size_t i = 0; i < seen.size(); ++i)
    EXPECT_EQ(seen[i], solver.iterations()[i] + 1);
}

TEST(Bfgs, ObserverMayEndTheRun) {
  Bfgs solver;
  int calls = 0;
  drive(solver, ClosedForm{"rosenbrock"}, starts(2, 5), [&](const Bfgs&) {
    return ++calls < 3;
  });
  EXPECT_EQ(calls, 3);
  EXPECT_FALSE(solver.pending());
  for (const Status s : solver.status()) EXPECT_EQ(s, Status::maxiter);
}

TEST(Bfgs, NothingToDo) {
  const Bfgs flat = solve(ClosedForm{"well"}, Batch<double>::Zero(2, 3));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(flat.status()[i], Status::gtol);
    EXPECT_EQ(flat.iterations()[i], 0);
    EXPECT_EQ(flat.evaluations()[i], 1);
  }
  const Bfgs none = solve(ClosedForm{"wavy"}, starts(2, 3), {.maxiter = 0});
  EXPECT_EQ(none.status()[0], Status::maxiter);
  EXPECT_EQ(none.evaluations()[0], 1);
  EXPECT_EQ(none.x(), starts(2, 3));
  const Bfgs two =
      solve(ClosedForm{"rosenbrock"}, starts(2, 3), {.maxiter = 2});
  EXPECT_EQ(two.status()[0], Status::maxiter);
  EXPECT_EQ(two.iterations()[0], 2);
  EXPECT_EQ(solve(ClosedForm{"wavy"}, Batch<double>(2, 0)).rounds(), 0);
}

TEST(Bfgs, SolvesInHigherDimensions) {
  const Index d = 60;
  const auto objective =
      single([&](const Vector<double>& x, Vector<double>& g) {
        double f = 0;
        for (Index j = 0; j < d; ++j) {
          const double k = 1 + static_cast<double>(j), r = x(j) - 1 / k;
          f += 0.5 * k * r * r;
          g(j) = k * r;
        }
        return f;
      });
  const Bfgs b = solve(objective, Batch<double>::Zero(d, 2), {.gtol = 1e-8});
  EXPECT_EQ(b.status()[1], Status::gtol);
  EXPECT_LT(b.loss()(1), 1e-15);
}

TEST(Bfgs, NonFiniteStart) {
  for (const double bad : {kNan, kInf, -kInf}) {
    const auto loss = single([&](const Vector<double>&, Vector<double>& g) {
      g.setOnes();
      return bad;
    });
    const auto slope = single([&](const Vector<double>& x, Vector<double>& g) {
      g.setOnes();
      g(0) = bad;
      return x.sum();
    });
    const Batch<double> x0 = starts(2, 1);
    for (const Bfgs& b : {solve(loss, x0), solve(slope, x0)}) {
      EXPECT_EQ(b.status()[0], Status::nonfinite);
      EXPECT_EQ(b.x(), x0);
      EXPECT_EQ(b.evaluations()[0], 1);
    }
  }
}

TEST(Bfgs, AStartThatIsNotFiniteIsLeftAsItIs) {
  test::expect_bad_starts_stay<Bfgs>(BfgsOptions{});
}

/// Counts what is evaluated, and what of it was the point before, per problem.
template <class F>
struct Watched {
  F f;
  std::vector<Vector<double>> last;
  std::vector<Index> made;
  Index repeated = 0;

  Watched(F objective, Index n)
      : f(objective),
        last(static_cast<std::size_t>(n)),
        made(static_cast<std::size_t>(n)) {}
  void operator()(std::span<const Index> active,
                  BatchIn<double> x,
                  VectorOut<double> loss,
                  BatchOut<double> gradient) {
    for (Index k = 0; k < x.cols(); ++k) {
      const auto i = static_cast<std::size_t>(active[std::size_t(k)]);
      const Vector<double> at = x.col(k);
      if (last[i].size() > 0 && test::same_bits(last[i], at)) ++repeated;
      last[i] = at;
      ++made[i];
    }
    f(active, x, loss, gradient);
  }
};

TEST(Bfgs, HandsBackWhatIsKnown) {
  // The first steps do not leave the start: they are lost in rounding.
  const auto flat = single([](const Vector<double>&, Vector<double>& g) {
    g.setConstant(1e-15);
    return 1.0;
  });
  const auto cliff = single([](const Vector<double>& x, Vector<double>& g) {
    g(0) = -1;
    return x(0) > 1 ? kNan : -x(0);
  });
  const auto check = [](auto objective, const Batch<double>& x0, double gtol) {
    const Index n = x0.cols();
    Watched watched(objective, n);
    Bfgs solver({.gtol = gtol});
    std::vector<Index> seen(static_cast<std::size_t>(n), 0);
    drive(solver, watched, x0, [&](const Bfgs& b) {
      for (const Index i : b.accepted())
        EXPECT_EQ(b.iterations()[std::size_t(i)], seen[std::size_t(i)]++);
    });
    EXPECT_EQ(watched.repeated, 0);
    EXPECT_EQ(watched.made, solver.evaluations());
    for (Index i = 0; i < n; ++i) {
      // Alone, so that batches may be of different lengths.
      const Bfgs one = solve(objective, x0.col(i), {.gtol = gtol});
      EXPECT_TRUE(test::same_bits(Vector<double>(one.x().col(0)),
                                  Vector<double>(solver.x().col(i))));
      EXPECT_EQ(one.evaluations()[0], solver.evaluations()[std::size_t(i)]);
    }
    return solver.skipped_trials();
  };
  EXPECT_GT(check(flat, Batch<double>::Constant(2, 3, 1e3), 1e-30), 2U);
  EXPECT_GT(check(cliff, Batch<double>::Constant(1, 4, 1), 1e-5), 0U);
  std::uint64_t skipped = 0;
  for (const char* name : {"abs", "rough", "wavy", "rosenbrock"})
    skipped += check(ClosedForm{name}, starts(2, 30), 1e-14);
  EXPECT_GT(skipped, 0U);
}

TEST(Bfgs, NonFiniteRegionIsNeverEntered) {
  // The logarithm's wall at 0 is in reach of the extrapolating search.
  const auto walled = single([](const Vector<double>& x, Vector<double>& g) {
    double f = 0;
    for (Index j = 0; j < x.size(); ++j) {
      f += 4 * x(j) - std::log(x(j));
      g(j) = 4 - 1 / x(j);
    }
    return f;  // NaN for x < 0
  });
  Batch<double> x0 = starts(2, 40).cwiseAbs().array() + 0.02;
  const Bfgs b = solve(walled, x0);
  EXPECT_TRUE(b.x().allFinite());
  EXPECT_TRUE(b.loss().allFinite());
  EXPECT_GT(b.x().minCoeff(), 0);

  // A cliff right in front: both searches meet it, x stays.
  const auto cliff = single([](const Vector<double>& x, Vector<double>& g) {
    g(0) = -1;
    return x(0) > 1 ? kNan : -x(0);
  });
  const Bfgs c = solve(cliff, Batch<double>::Constant(1, 1, 1));
  EXPECT_EQ(c.status()[0], Status::nonfinite);
  EXPECT_EQ(c.x()(0), 1);
  EXPECT_EQ(c.loss()(0), -1);
  // The second search begins where the first one ended.
  EXPECT_EQ(c.evaluations()[0], 2);
  EXPECT_EQ(c.skipped_trials(), 1U);
}

TEST(Bfgs, RecoversFromAWallOfInfinity) {
  // SciPy 1.10.1 ends at 0.01 with a loss of 4.1e-29 from both starts.
  const auto walled = single([](const Vector<double>& x, Vector<double>& g) {
    g(0) = 2e4 * (x(0) - 0.01);
    return x(0) < 0 ? kInf : 1e4 * (x(0) - 0.01) * (x(0) - 0.01);
  });
  for (const double from : {1.0, 0.8}) {
    const Bfgs b = solve(walled, Batch<double>::Constant(1, 1, from));
    EXPECT_EQ(b.status()[0], Status::gtol);
    EXPECT_NEAR(b.x()(0), 0.01, 1e-9);
    EXPECT_LT(b.loss()(0), 1e-12);
  }
}

TEST(Bfgs, BacksOffAtNanWhereItIsAsked) {
  for (const double wall : {kNan, kInf, -kInf}) {
    const auto walled =
        single([wall](const Vector<double>& x, Vector<double>& g) {
          g(0) = x(0) < 0 ? kNan : 2e4 * (x(0) - 0.01);
          return x(0) < 0 ? wall : 1e4 * (x(0) - 0.01) * (x(0) - 0.01);
        });
    const Batch<double> x0 = Batch<double>::Constant(1, 1, 0.8);
    const BfgsOptions asked{.search = {.back_off = true}};
    const Bfgs with = solve(walled, x0, asked), without = solve(walled, x0);
    EXPECT_EQ(with.status()[0], Status::gtol);
    EXPECT_NEAR(with.x()(0), 0.01, 1e-9);
    EXPECT_EQ(without.x()(0) == 0.8, wall != kInf);
  }
  // Where all is finite there is nothing to back off from.
  const Batch<double> x0 = starts(3, 30);
  for (const char* name : {"wavy", "rosenbrock", "abs"}) {
    const Bfgs plain = solve(ClosedForm{name}, x0);
    const Bfgs asked =
        solve(ClosedForm{name}, x0, {.search = {.back_off = true}});
    EXPECT_TRUE(test::same_bits(plain.x(), asked.x()));
    EXPECT_EQ(plain.evaluations(), asked.evaluations());
  }
}

TEST(Bfgs, FirstTrialsAreAsLongAsAsked) {
  // Down a slope without end; the second point evaluated is the first trial.
  const auto length = [](FirstTrial rule, double norm) {
    double first = 0;
    Index calls = 0;
    const auto slope = single([&](const Vector<double>& x, Vector<double>& g) {
      if (++calls == 2) first = -x(0);
      g(0) = norm;
      return norm * x(0);
    });
    Bfgs solver({.gtol = 1e-12, .maxiter = 1, .first_trial = rule});
    drive(solver, slope, Batch<double>::Zero(1, 1));
    return first;
  };
  struct Case {
    FirstTrial rule;
    double steep, shallow;  // at gradients of 1e4 and 1e-4
  };
  for (const Case& c : {Case{FirstTrial::scipy, 1.01, 1e-4},
                        Case{FirstTrial::shorter, 1, 1e-4},
                        Case{FirstTrial::gradient, 1e4, 1e-4},
                        Case{FirstTrial::tenth_gradient, 1e3, 1e-5},
                        Case{FirstTrial::length_1, 1, 1},
                        Case{FirstTrial::length_tenth, 0.1, 0.1}}) {
    for (const auto& [norm, expected] :
         {std::pair(1e4, c.steep), std::pair(1e-4, c.shallow)}) {
      EXPECT_NEAR(length(c.rule, norm), expected, 1e-9 * expected)
          << to_string(c.rule) << " " << norm;
      EXPECT_NEAR(first_trial(c.rule, norm) * norm, expected, 1e-9 * expected);
    }
  }
}

TEST(Bfgs, OverflowingPointsAreNotEvaluated) {
  // tanh is finite at infinity, with a gradient of 0: a trap.
  const auto trap = single([](const Vector<double>& x, Vector<double>& g) {
    EXPECT_TRUE(x.allFinite());
    g(0) = -1e300;
    return std::tanh(-x(0));
  });
  const Bfgs b = solve(trap, Batch<double>::Constant(1, 1, 1.7e308));
  EXPECT_TRUE(b.x().allFinite());
  EXPECT_TRUE(b.loss().allFinite());
}

TEST(Bfgs, KinksEndFiniteAndLower) {
  const Batch<double> x0 = starts(3, 100);
  const Bfgs b = solve(ClosedForm{"abs"}, x0);
  for (Index i = 0; i < x0.cols(); ++i) {
    EXPECT_TRUE(b.x().col(i).allFinite());
    EXPECT_LE(b.loss()(i), x0.col(i).cwiseAbs().sum());
  }
}

/// The matrix product of the definition.
Batch<double> product_form(const Batch<double>& h,
                           const Vector<double>& s,
                           const Vector<double>& y,
                           double rho) {
  const Index d = s.size();
  const Batch<double> one = Batch<double>::Identity(d, d);
  return (one - rho * s * y.transpose()) * h * (one - rho * y * s.transpose()) +
         rho * s * s.transpose();
}

TEST(BfgsUpdate, EqualsTheMatrixProduct) {
  for (const Index d : {1, 2, 3, 4, 5, 9}) {
    Batch<double> h = starts(d, d);  // not even symmetric
    const Vector<double> s = starts(d, 1), y = starts(d, 2).col(1);
    Vector<double> scratch(d);
    const Batch<double> expected = product_form(h, s, y, 1 / y.dot(s));
    dense::bfgs_update(d, s.data(), y.data(), h.data(), scratch.data());
    EXPECT_TRUE(test::Comparator(1e-11, 0)(h, expected)) << d;
  }
}

// Two unknowns have a way of their own; zeros add nothing.
TEST(BfgsUpdate, TwoUnknownsGoAsTwoOfThree) {
  for (int k = 0; k < 50; ++k) {
    const Batch<double> h = starts(2, 2 + k).rightCols(2);
    Batch<double> two = h, three = Batch<double>::Zero(3, 3);
    three.topLeftCorner(2, 2) = h;
    Vector<double> s = Vector<double>::Zero(3), y = s, scratch(3);
    s.head(2) = starts(2, 7 + k).rightCols(1);
    y.head(2) = starts(2, 9 + k).rightCols(1);
    if (k == 7) y << s(1), -s(0), 0;  // no curvature
    if (k == 8) s(1) = 0;
    dense::bfgs_update(2, s.data(), y.data(), two.data(), scratch.data());
    dense::bfgs_update(3, s.data(), y.data(), three.data(), scratch.data());
    EXPECT_EQ(two, three.topLeftCorner(2, 2)) << k;
  }
}

TEST(BfgsUpdate, NormsOfAnySize) {
  Vector<double> a(7);
  a << 3, -1, 0, 4, 1e-3, -2, 0.5;
  const double norm = dense::norm(7, a.data());
  EXPECT_EQ(norm, std::sqrt(dense::dot(7, a.data(), a.data())));
  for (const double size : {1e-300, 1e-200, 1e-150, 1e150, 1e200, 1e307}) {
    const Vector<double> b = size * a;
    EXPECT_NEAR(dense::norm(7, b.data()) / size, norm, 1e-14 * norm) << size;
  }
  EXPECT_EQ(dense::norm(3, Vector<double>::Zero(3).eval().data()), 0);
  a(2) = kInf;
  EXPECT_EQ(dense::norm(7, a.data()), kInf);
  a(2) = kNan;
  EXPECT_TRUE(std::isnan(dense::norm(7, a.data())));
}

TEST(BfgsUpdate, NoCurvatureAndNegativeCurvature) {
  const Vector<double> s = (Vector<double>(2) << 1, 1).finished();
  Vector<double> y = (Vector<double>(2) << 1, -1).finished(), scratch(2);
  Batch<double> h = Batch<double>::Identity(2, 2);
  dense::bfgs_update(2, s.data(), y.data(), h.data(), scratch.data());
  EXPECT_TRUE(test::Comparator(1e-12, 0)(
      h, product_form(Batch<double>::Identity(2, 2), s, y, 1000)));
  y << -2, 1;
  h.setIdentity();
  dense::bfgs_update(2, s.data(), y.data(), h.data(), scratch.data());
  EXPECT_TRUE(test::Comparator(1e-12, 0)(
      h, product_form(Batch<double>::Identity(2, 2), s, y, -1)));
  EXPECT_LT(y.dot(h * y), 0);  // kept, not repaired
}

TEST(Bfgs, RefusesOptionsThatAreNoNumbers) {
  const Batch<double> x0 = starts(2, 1);
  for (const BfgsOptions& bad :
       {BfgsOptions{.gtol = kNan},
        BfgsOptions{.gtol = -1},
        BfgsOptions{.maxiter = -1},
        BfgsOptions{.stall = kNan},
        BfgsOptions{.search = {.decrease = kNan}},
        BfgsOptions{.search = {.decrease = 0.95}},
        BfgsOptions{.search = {.curvature = 1}},
        BfgsOptions{.search = {.min_step = 2, .max_step = 1}},
        BfgsOptions{.search = {.max_evaluations = 0}},
        BfgsOptions{.search = {.max_together = 0}}})
    EXPECT_THROW(solve(ClosedForm{"wavy"}, x0, bad), ContractError);
}

// A long valley: every step helps, ever less.
TEST(Bfgs, StopsWhereThreeStepsLowerTheLossByTooLittle) {
  const auto valley = single([](const Vector<double>& x, Vector<double>& g) {
    g(0) = 4 * std::pow(x(0), 3);
    return 1 + std::pow(x(0), 4);
  });
  const BfgsOptions plain{.gtol = 1e-12},
      stalling{.gtol = 1e-12, .stall = 1e-3};
  std::vector<double> losses;
  Bfgs solver(stalling);
  drive(solver, valley, Batch<double>::Constant(1, 1, 2), [&](const Bfgs& b) {
    losses.push_back(b.loss()(0));
  });
  const std::size_t last = losses.size() - 1;
  ASSERT_GT(last, 3U);
  EXPECT_EQ(solver.status()[0], Status::ftol);
  EXPECT_LT(losses[last - 3] - losses[last], 1e-3 * losses[last - 3]);
  EXPECT_GE(losses[last - 4] - losses[last - 1], 1e-3 * losses[last - 4]);
  const Bfgs whole = solve(valley, Batch<double>::Constant(1, 1, 2), plain);
  EXPECT_GT(whole.iterations()[0], solver.iterations()[0]);
}

TEST(Bfgs, SearchesTogetherStayWithinTheirEvaluations) {
  // Falls at 0 and nowhere else.
  const auto kink = single([](const Vector<double>& x, Vector<double>& g) {
    g(0) = x(0) == 1 ? 1 : -1;
    return 1 + std::abs(x(0) - 1);
  });
  for (const int most : {5, 20}) {
    const Bfgs solver = solve(
        kink, Batch<double>::Ones(1, 1), {.search = {.max_together = most}});
    EXPECT_EQ(solver.status()[0], Status::linesearch);
    EXPECT_EQ(
        solver.evaluations()[0] + static_cast<Index>(solver.skipped_trials()),
        1 + most);
  }
}

}  // namespace
}  // namespace physinv
