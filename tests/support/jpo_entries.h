/// Entries that the reference files of several JPO experiments share, each
/// checked by what carries it out.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "optimizers/drive.h"
#include "optimizers/gradient_descent.h"
#include "suite/core/any_problem.h"
#include "tests/support/physics.h"
#include "tests/support/reference.h"

namespace physinv::test {

/// The losses of problems with observations target.col(i), for the solvers.
struct Matching {
  Batch<double> targets;
  ProblemRecipe recipe;

  void operator()(std::span<const Index> active,
                  BatchIn<double> x,
                  VectorOut<double> loss,
                  BatchOut<double> gradient) const {
    Physics at{AnyProblem<double>(recipe)};
    const std::vector<Index> some(active.begin(), active.end());
    const auto found =
        at.losses(x,
                  Batch<double>::Zero(at.problem.shape().given, x.cols()),
                  targets(Eigen::all, some));
    loss = found.loss, gradient = found.x_bar;
  }
};

/// The percentile is the number at the end of the entry's name.
void check_clip(const Json& entry);
void check_boundary(const Json& entry);
void check_test_functions(const Json& entry);

/// Every iterate and loss of gradient descent on so many problems.
/// `step_tolerance` is the specification's gtol, where the entry has none.
template <class F>
void check_descent(const Json& entry,
                   const F& problems,
                   Index unknowns,
                   Index count,
                   double step_tolerance) {
  const auto near = EntryTolerance(entry).array();
  const Json xs = entry.at("x_after_iteration"),
             losses = entry.at("loss_after_iteration");
  ASSERT_EQ(xs.size(), losses.size());
  ASSERT_FALSE(xs.empty());
  std::vector<Batch<double>> x;
  std::vector<Vector<double>> loss;
  const GradientDescentOptions options{
      .step_tolerance = setting(entry, "gtol", "gtol", step_tolerance),
      .maxiter = static_cast<Index>(xs.size()) - 1};
  GradientDescent gd(options);
  const Batch<double> start = columns(xs.at(0), unknowns, count);
  drive(gd, problems, start, [&](const GradientDescent& g) {
    if (g.accepted().empty()) return;
    x.push_back(g.x());
    loss.push_back(g.loss());
  });
  ASSERT_FALSE(x.empty());
  for (std::size_t k = 0; k < xs.size(); ++k) {
    // Stopped problems stay where they are.
    const std::size_t at = std::min(k, x.size() - 1);
    EXPECT_TRUE(near(x[at], columns(xs[k]))) << "iteration " << k;
    EXPECT_TRUE(near(loss[at], vector(losses[k]))) << "iteration " << k;
  }
  const Vector<double> evaluations = vector(entry.at("evaluations"), count);
  const Batch<double> stored = columns(losses, count);
  for (Index i = 0; i < evaluations.size(); ++i) {
    // Where the loss no longer changes, the last bit decides about one more.
    bool free = false;
    for (std::size_t k = 1; k < xs.size(); ++k) {
      const double now = stored(i, Index(k)), before = stored(i, Index(k) - 1);
      free = free || std::abs(now - before) <= 1e-12 * std::abs(before);
    }
    EXPECT_NEAR(
        static_cast<double>(gd.evaluations()[static_cast<std::size_t>(i)]),
        evaluations(i),
        free ? static_cast<double>(1 + options.substeps) : 0)
        << "problem " << i;
  }
}

}  // namespace physinv::test
