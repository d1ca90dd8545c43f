// Work that is not done: the same results with and without each skip, and the
// counter equals the work saved.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "optimizers/bfgs.h"
#include "optimizers/drive.h"
#include "optimizers/gradient_descent.h"
#include "optimizers/jpo.h"
#include "optimizers/network_model.h"
#include "problems/billiards/billiards.h"
#include "suite/core/any_problem.h"
#include "suite/core/oracle.h"
#include "suite/nn/mlp.h"
#include "tests/support/bits.h"
#include "tests/support/quadratic.h"
#include "tests/support/tolerance.h"

namespace physinv::test {
namespace {

constexpr Index kCount = 61;

ProblemRecipe billiards() { return problems::billiards(); }

Oracle make_oracle(Needs needs = Needs::forward | Needs::vjp) {
  return Oracle(billiards(), kCount, Rng::root("skip_test", 1), needs);
}

std::uint64_t u64(Index n) { return static_cast<std::uint64_t>(n); }

/// The start meets the ball of these problems.
std::vector<Index> hits(const Batch<double>& balls) {
  std::vector<Index> which;
  for (Index i = 0; i < balls.cols(); ++i)
    if (collide<double>({1, 0}, {balls(0, i), balls(1, i)}).hit)
      which.push_back(i);
  return which;
}

TEST(Skip, GradientsOfMisses) {
  Oracle oracle = make_oracle(), some = make_oracle();
  const auto hit = hits(oracle.given());
  const auto h = static_cast<Index>(hit.size());
  ASSERT_GT(h, 10);
  ASSERT_LT(h, kCount - 5);
  const Batch<double> x = oracle.start();
  Batch<double> all(2, kCount), of_hits(2, h);
  Vector<double> loss(kCount);
  oracle.evaluate<double>(oracle.all(), x, loss, all);
  EXPECT_EQ(oracle.counts()[Counter::skipped_vjp], u64(kCount - h));
  some.evaluate<double>(hit, x.leftCols(h), loss.head(h), of_hits);
  EXPECT_EQ(some.counts()[Counter::skipped_vjp], 0U);
  EXPECT_TRUE(same_bits(Batch<double>(all(Eigen::all, hit)), of_hits));

  // Without the skip: the transposed Jacobian of every sample.
  const AnyProblem<double> problem(problems::billiards());
  Workspace work;
  Batch<double> y(2, kCount), j(4, kCount);
  problem.forward(x, oracle.given(), y, work);
  problem.jacobian(x, oracle.given(), j, work);
  for (Index i = 0; i < kCount; ++i) {
    const Eigen::Map<const Eigen::Matrix2d> ji(j.col(i).data());
    const Vector<double> full =
        ji.transpose() * (y.col(i) - oracle.observations().col(i));
    EXPECT_TRUE(Comparator(1e-12, 0)(all.col(i), full));
    if (full.norm() == 0) {
      EXPECT_TRUE(same_bits(Vector<double>(all.col(i)),
                            Vector<double>::Zero(2).eval()));
    }
  }
}

TEST(Skip, MotionNobodyObserves) {
  Oracle oracle = make_oracle();
  const auto hit = hits(oracle.given());
  const AnyProblem<double> problem(problems::billiards());
  Workspace work;
  Batch<double> y(2, kCount);
  problem.forward(oracle.start(), oracle.given(), y, work);
  EXPECT_EQ(work.counts[Counter::skipped_events], hit.size());
  std::uint64_t events = 0;
  for (Index i = 0; i < kCount; ++i) {
    const auto path =
        simulate_events({1, 0}, {oracle.given()(0, i), oracle.given()(1, i)});
    events += u64(path.events);
    EXPECT_TRUE(Comparator(1e-12, 0)(
        y.col(i), Eigen::Vector2d(path.final_ball[0], path.final_ball[1])));
  }
  EXPECT_EQ(events, hit.size());
}

/// Runs `solver`; a fixed batch evaluates its finished problems again.
template <class Solver>
std::uint64_t solve(Solver& solver, Oracle& oracle, bool fixed_batch) {
  Batch<double> all = oracle.start(), gradient(2, kCount);
  Vector<double> loss(kCount);
  drive(
      solver,
      [&](std::span<const Index> active,
          BatchIn<double> x,
          VectorOut<double> l,
          BatchOut<double> g) {
        if (!fixed_batch) return oracle.evaluate<double>(active, x, l, g);
        const auto at = [&](Index j) {
          return active[static_cast<std::size_t>(j)];
        };
        for (Index j = 0; j < x.cols(); ++j) all.col(at(j)) = x.col(j);
        oracle.evaluate<double>(oracle.all(), all, loss, gradient);
        for (Index j = 0; j < x.cols(); ++j)
          l(j) = loss(at(j)), g.col(j) = gradient.col(at(j));
      },
      oracle.start());
  return oracle.counts()[Counter::vjp];
}

template <class Solver>
void expect_same_end(const Solver& a, const Solver& b) {
  EXPECT_TRUE(same_bits(a.x(), b.x()));
  EXPECT_TRUE(same_bits(a.loss(), b.loss()));
  EXPECT_EQ(a.status(), b.status());
  EXPECT_EQ(a.iterations(), b.iterations());
  EXPECT_EQ(a.evaluations(), b.evaluations());
}

template <class Solver>
void expect_saved_evaluations(Solver with) {
  Solver without(with);
  Oracle a = make_oracle(), b = make_oracle();
  const auto made = solve(with, a, false), full = solve(without, b, true);
  expect_same_end(with, without);
  EXPECT_GT(with.skipped_evaluations(), 0U);
  EXPECT_EQ(made + with.skipped_evaluations(), full);
}

TEST(Skip, EvaluationsOfFinishedProblems) {
  expect_saved_evaluations(Bfgs());
  expect_saved_evaluations(GradientDescent({.skip_zero_gradient = false}));
}

TEST(Skip, TrialsAlongZeroGradients) {
  GradientDescent with, without({.skip_zero_gradient = false});
  Oracle a = make_oracle(), b = make_oracle();
  const auto made = solve(with, a, false), full = solve(without, b, false);
  expect_same_end(with, without);
  EXPECT_GT(with.skipped_trials(), 0U);
  EXPECT_EQ(made + with.skipped_trials(), full);
}

TEST(Skip, FeaturesAndConstantRowsOfTheNetwork) {
  Oracle oracle = make_oracle();
  const NetworkRole role{
      {Field::given, Field::observations},
      nn::mlp({.hidden = {128, 128, 128}, .frequencies = 4})};
  NetworkModel<double> model(role, oracle.shape(), 2, nullptr);
  model.initialize(Rng::root("skip_test", 2));
  const auto input = assemble<double>(
      role.inputs, oracle.start(), oracle.given(), oracle.observations());
  model.bind(input);

  // Without the skips: the network itself, every pass from the start.
  const auto& network = model.network();
  Tape tape;
  Workspace work;
  Batch<double> full(2, kCount);
  Vector<double> bar(network.parameter_count());
  VectorOut<double> bar_ref(bar);
  constexpr Index kPasses = 3;
  for (Index pass = 0; pass < kPasses; ++pass) {
    const Batch<double> out = model.forward();
    network.forward(model.parameters(), model.state(), input, full, tape, work);
    EXPECT_TRUE(Comparator(1e-12, 0)(out, full));
    const Vector<double> skipped = model.backward(out);
    network.backward(model.parameters(), tape, out, &bar_ref, nullptr, work);
    for (const TensorInfo& t : network.tensors())
      EXPECT_TRUE(Comparator(1e-11, 0)(skipped.segment(t.offset, t.size),
                                       bar.segment(t.offset, t.size)))
          << t.name;
    model.parameters() -= 1e-3 * skipped;
  }
  EXPECT_EQ(work.counts[Counter::skipped_features], 0U);
  EXPECT_EQ(work.counts[Counter::skipped_rows], 0U);
  // Encoded once; of 32 features the ball's x and the target make 24.
  EXPECT_EQ(model.counts()[Counter::skipped_features],
            u64((kPasses - 1) * kCount));
  EXPECT_EQ(model.counts()[Counter::skipped_rows], u64(kPasses * 24 * kCount));
}

// The gradient at the last iterate is not needed. The losses of a longer run
// show what a gradient there would have changed: nothing.
TEST(Skip, TheGradientAtTheLastEstimateOfJpo) {
  const auto jpo = jpo_fit();
  const Setting setting{
      .predictor = {{Field::given, Field::observations},
                    nn::mlp({.hidden = {32}, .frequencies = 4})},
      .surrogate = {}};
  constexpr Index kSteps = 6;
  StageBench ends(*jpo, kCount, kSteps, billiards(), setting);
  StageBench goes_on(*jpo, kCount, kSteps + 1, billiards(), setting);
  const Outcome out = ends.run();
  goes_on.run();
  const Batch<double> losses = ends.traced<double>(kCount);
  ASSERT_EQ(losses.cols(), kSteps + 1);
  EXPECT_TRUE(same_bits(
      losses,
      Batch<double>(goes_on.traced<double>(kCount).leftCols(kSteps + 1))));
  EXPECT_EQ(ends.oracle.counts()[Counter::vjp], u64(kSteps * kCount));
  EXPECT_EQ(ends.oracle.counts()[Counter::forward], u64(kCount));
  EXPECT_TRUE(
      same_bits(ends.loss(out.x), Vector<double>(losses.rowwise().minCoeff())));
}

}  // namespace
}  // namespace physinv::test
