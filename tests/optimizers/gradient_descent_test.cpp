#include "optimizers/gradient_descent.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "optimizers/bold_descent.h"
#include "optimizers/drive.h"
#include "suite/core/check.h"
#include "tests/optimizers/functions.h"
#include "tests/support/bits.h"
#include "tests/support/jpo_entries.h"
#include "tests/support/reference.h"

namespace physinv {
namespace {

using test::Billiards;
using test::ClosedForm;
using test::same_bits;
using test::single;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(GradientDescentReference, Billiards) {
  test::check_entries_named(
      "jpo-billiards", "gd_adaptive", [](const test::Json& entry) {
        const Billiards problems{test::columns(entry.at("balls"), 2)};
        // Section 2: gtol.
        test::check_descent(entry, problems, 2, problems.balls.cols(), 1e-5);
      });
}

/// The batch of problems whose aiming angles reach from plateau to centre.
Billiards table(Index n) {
  Batch<double> balls(2, n);
  for (Index i = 0; i < n; ++i)
    balls.col(i) << 1, (static_cast<double>(i) + 0.5) / static_cast<double>(n);
  return {balls};
}

Batch<double> cue(Index n) {
  Batch<double> x(2, n);
  for (Index i = 0; i < n; ++i) x.col(i) << 1, 0;
  return x;
}

TEST(GradientDescent, SkippingZeroGradientsChangesNothing) {
  const Index n = 40;
  const auto run = [&](bool skip,
                       Index maxiter,
                       const Billiards& problem,
                       BatchIn<double> x0) {
    GradientDescent gd({.maxiter = maxiter, .skip_zero_gradient = skip});
    drive(gd, problem, x0);
    return gd;
  };
  Billiards flat = table(n);
  flat.balls.row(1).setConstant(0.02);  // no problem is hit
  for (const Billiards& problem : {table(n), flat}) {
    for (const Index maxiter : {0, 1, 3, 50, 300}) {
      const GradientDescent with = run(true, maxiter, problem, cue(n));
      const GradientDescent without = run(false, maxiter, problem, cue(n));
      EXPECT_EQ(with.x(), without.x());
      EXPECT_EQ(with.loss(), without.loss());
      EXPECT_EQ(with.status(), without.status());
      EXPECT_EQ(with.iterations(), without.iterations());
      EXPECT_EQ(with.evaluations(), without.evaluations());
      EXPECT_EQ(without.skipped_trials(), 0U);
      EXPECT_EQ(with.skipped_trials() > 0, maxiter > 0);
    }
  }
  const GradientDescent all = run(true, 10, flat, cue(n));
  EXPECT_EQ(all.rounds(), 1);
  EXPECT_EQ(all.evaluations()[0], 3);
  EXPECT_EQ(all.skipped_trials(), static_cast<std::uint64_t>(2 * n));
}

TEST(GradientDescent, CountsAddUp) {
  const Index n = 40;
  GradientDescent gd;
  std::uint64_t made = 0;
  const Billiards problem = table(n);
  const auto counted = [&](std::span<const Index> active,
                           BatchIn<double> x,
                           VectorOut<double> loss,
                           BatchOut<double> gradient) {
    made += active.size();
    problem(active, x, loss, gradient);
  };
  drive(gd, counted, cue(n));
  std::uint64_t written = 0;
  for (const Index e : gd.evaluations())
    written += static_cast<std::uint64_t>(e);
  EXPECT_EQ(written, made + gd.skipped_trials());
}

// The start is iterate 0; a problem's numbers have no gaps up to its end.
TEST(GradientDescent, AnnouncesEveryIterateWithItsNumber) {
  const Index n = 40;
  std::vector<Index> next(static_cast<std::size_t>(n), 0);
  GradientDescent gd({.skip_zero_gradient = false});
  drive(gd, table(n), cue(n), [&](const GradientDescent& g) {
    for (const Index i : g.accepted()) {
      const auto k = static_cast<std::size_t>(i);
      EXPECT_EQ(g.iterations()[k], next[k]++);
    }
  });
  for (std::size_t k = 0; k < next.size(); ++k)
    EXPECT_EQ(gd.iterations()[k], next[k] - 1);
}

TEST(GradientDescent, DescendsAndConverges) {
  Batch<double> x0(2, 3);
  x0 << 0.5, -1, 2, 1, 0.3, -0.7;
  GradientDescent gd;
  Vector<double> before = Vector<double>::Constant(3, 1e300);
  drive(gd, ClosedForm{"wavy"}, x0, [&](const GradientDescent& g) {
    for (Index i = 0; i < 3; ++i) {
      EXPECT_LE(g.loss()(i), before(i));
      before(i) = g.loss()(i);
    }
  });
  for (Index i = 0; i < 3; ++i) {
    Vector<double> g;
    test::closed_form("wavy", gd.x().col(i), g);
    EXPECT_EQ(gd.status()[static_cast<std::size_t>(i)], Status::gtol);
    EXPECT_LT(g.norm(), 1e-3);
  }
}

TEST(GradientDescent, NonFiniteTrialsShortenTheStep) {
  // Everything beyond 1 is NaN; the first step of 0.1 * 20 lands there.
  const auto wall = single([](const Vector<double>& x, Vector<double>& g) {
    g(0) = -20;
    return x(0) > 1 ? kNan : -20 * x(0);
  });
  GradientDescent gd({.maxiter = 5});
  drive(gd, wall, Batch<double>::Zero(1, 2));
  EXPECT_TRUE(gd.x().allFinite());
  EXPECT_GT(gd.x()(0), 0.1);
  EXPECT_LE(gd.x()(0), 1);
}

TEST(GradientDescent, UselessDirectionsDiverge) {
  // The gradient points the wrong way: no step lowers the loss.
  const auto wrong = single([](const Vector<double>& x, Vector<double>& g) {
    g(0) = -1e9;
    return 1e9 * x(0);
  });
  GradientDescent gd({.first_step = 1e9, .substeps = 3});
  drive(gd, wrong, Batch<double>::Zero(1, 1));
  EXPECT_EQ(gd.status()[0], Status::linesearch);
  EXPECT_EQ(gd.x()(0), 0);
  EXPECT_EQ(gd.evaluations()[0], 1 + 1 + 3);
}

TEST(GradientDescent, NonFiniteStart) {
  const auto nan = single([](const Vector<double>&, Vector<double>& g) {
    g.setConstant(kNan);
    return kNan;
  });
  for (const bool skip : {false, true}) {
    GradientDescent gd({.skip_zero_gradient = skip});
    drive(gd, nan, Batch<double>::Ones(2, 3));
    EXPECT_EQ(gd.status()[2], Status::nonfinite);
    EXPECT_EQ(gd.x(), Batch<double>::Ones(2, 3));
  }
}

TEST(GradientDescent, AStartWithoutAGradientHasItsLoss) {
  const auto cliff = [](std::span<const Index> active,
                        BatchIn<double> x,
                        VectorOut<double> loss,
                        BatchOut<double> gradient) {
    for (Index i = 0; i < x.cols(); ++i) {
      const bool blind = active[static_cast<std::size_t>(i)] == 0;
      loss(i) = blind ? 7 : 0.5 * x(0, i) * x(0, i);
      gradient(0, i) = blind ? kNan : x(0, i);
    }
  };
  Batch<double> x0(1, 2);
  x0 << 3, 1;
  GradientDescent gd, alone;
  drive(gd, cliff, x0, [](const GradientDescent& g) {
    for (const Index i : g.accepted()) EXPECT_EQ(i, 1);
  });
  EXPECT_EQ(gd.status()[0], Status::nonfinite);
  EXPECT_EQ(gd.loss()(0), 7);
  EXPECT_EQ(gd.x()(0), 3);
  EXPECT_EQ(gd.iterations()[0], 0);
  EXPECT_EQ(gd.evaluations()[0], 1);
  // Others continue as if it were not there.
  EXPECT_EQ(gd.status()[1], Status::gtol);
  drive(
      alone,
      [&](auto, BatchIn<double> x, auto&& loss, auto&& gradient) {
        const Index second = 1;
        cliff({&second, 1}, x, loss, gradient);
      },
      x0.rightCols(1));
  EXPECT_TRUE(same_bits(Batch<double>(gd.x().rightCols(1)), alone.x()));
}

template <class Solver>
void expect_finite_paths() {
  // Finite everywhere, at infinity too, where it is lowest.
  const auto slope = single([](const Vector<double>& x, Vector<double>& g) {
    g.setConstant(-1e300);
    return std::isnan(x(0)) ? 0 : std::tanh(-x(0));
  });
  for (const double bad : {kNan, HUGE_VAL, -HUGE_VAL}) {
    Batch<double> x0(2, 3);
    x0 << 0.5, bad, 1, bad, 0.25, 1.7e308;
    Solver solver;
    drive(
        solver,
        [&](std::span<const Index> active, auto&&... in_and_out) {
          for (const Index i : active) EXPECT_EQ(i, 2);
          slope(active, in_and_out...);
        },
        x0);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(solver.status()[i], Status::nonfinite);
      EXPECT_EQ(solver.evaluations()[i], 0);
    }
    EXPECT_TRUE(same_bits(Batch<double>(solver.x().leftCols(2)),
                          Batch<double>(x0.leftCols(2))));
    EXPECT_TRUE(solver.x().col(2).allFinite());
    EXPECT_TRUE(std::isfinite(solver.loss()(2)));
  }
}

TEST(GradientDescent, NeitherStartNorStepIsBeyondTheNumbers) {
  expect_finite_paths<GradientDescent>();
}

TEST(BoldDescent, NeitherStartNorStepIsBeyondTheNumbers) {
  expect_finite_paths<BoldDescent>();
}

TEST(GradientDescent, RefusesOptionsThatAreNoNumbers) {
  for (const GradientDescentOptions& bad :
       {GradientDescentOptions{.first_step = 0},
        GradientDescentOptions{.first_step = kNan},
        GradientDescentOptions{.first_step = HUGE_VAL},
        GradientDescentOptions{.step_tolerance = kNan},
        GradientDescentOptions{.step_tolerance = -1},
        GradientDescentOptions{.maxiter = -1},
        GradientDescentOptions{.substeps = 0}})
    EXPECT_THROW(GradientDescent(bad).start(Batch<double>::Ones(1, 1)),
                 ContractError);
  for (const BoldDescentOptions& bad : {BoldDescentOptions{.first_step = -1},
                                        BoldDescentOptions{.first_step = kNan},
                                        BoldDescentOptions{.longer = 0.9},
                                        BoldDescentOptions{.longer = kNan},
                                        BoldDescentOptions{.shorter = 0},
                                        BoldDescentOptions{.shorter = 1},
                                        BoldDescentOptions{.shorter = kNan},
                                        BoldDescentOptions{.evaluations = -1}})
    EXPECT_THROW(BoldDescent(bad).start(Batch<double>::Ones(1, 1)),
                 ContractError);
}

/// 1/2 |x|^2, and no number left of -1.
const auto bowl = single([](const Vector<double>& x, Vector<double>& g) {
  g = x;
  return x(0) < -1 ? kNan : 0.5 * x.squaredNorm();
});

TEST(BoldDescent, WalksByItsRule) {
  BoldDescent gd({.evaluations = 4});
  drive(gd, bowl, Batch<double>::Constant(1, 1, 4));
  // Steps are cut to length a where the gradient is longer than 1.
  double x = 4, a = 0.1;
  for (int k = 0; k < 4; ++k, a *= 1.5) x -= a;
  EXPECT_NEAR(gd.x()(0), x, 1e-14);
  EXPECT_EQ(gd.iterations()[0], 4);
  EXPECT_EQ(gd.evaluations()[0], 5);
  EXPECT_EQ(gd.status()[0], Status::maxiter);
}

TEST(BoldDescent, HalvesWhatDoesNotHelp) {
  BoldDescent gd({.first_step = 4, .evaluations = 2});
  drive(gd, bowl, Batch<double>::Constant(1, 1, 1));
  // To -3, where there is no number; to -1, no better; then to 0.
  EXPECT_EQ(gd.x()(0), 1);
  EXPECT_EQ(gd.iterations()[0], 0);
  BoldDescent further({.first_step = 4, .evaluations = 3});
  drive(further, bowl, Batch<double>::Constant(1, 1, 1));
  EXPECT_EQ(further.x()(0), 0);
  EXPECT_EQ(further.status()[0], Status::gtol);
}

TEST(BoldDescent, ProblemsDoNotFeelEachOther) {
  Batch<double> starts(2, 3);
  starts << 1, -2, 0, 3, 0.5, 0;
  BoldDescent together;
  drive(together, bowl, starts);
  EXPECT_EQ(together.status()[1], Status::nonfinite);
  EXPECT_EQ(together.status()[2], Status::gtol);
  EXPECT_GT(together.skipped_evaluations(), 0U);
  BoldDescent alone;
  drive(alone, bowl, starts.leftCols(1));
  EXPECT_EQ(alone.x(), together.x().leftCols(1));
  EXPECT_LT(alone.loss()(0), 1e-6);
}

}  // namespace
}  // namespace physinv
