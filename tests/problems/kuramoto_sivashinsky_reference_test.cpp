// Every entry of jpo-kuramoto-sivashinsky that is physics or a solver's.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "suite/core/any_problem.h"
#include "suite/nn/vgg.h"
#include "tests/support/jpo_entries.h"
#include "tests/support/jpo_reference.h"
#include "tests/support/physics.h"
#include "tests/support/run_reference.h"

namespace physinv::test {
namespace {

const std::string kId = "jpo-kuramoto-sivashinsky";

/// What a comparison in T allows: the file's tolerance in double.
template <class T>
Comparator within(const Json& entry, double in_float) {
  if constexpr (sizeof(T) == 8) return EntryTolerance(entry).array();
  return {in_float, 0};
}

Samples<double> problems_of(const Json& entry) {
  const Batch<double> u0 = columns(entry.at("u0"));
  return {columns(entry.at("true"), 2, u0.cols()),
          columns(entry.at("uT"), u0.rows(), u0.cols()),
          u0};
}

/// The inverse problems that several entries speak about, by column.
Samples<double> problems() { return problems_of(spoken_of(kId, "problems")); }

/// As many cells as the states have; everything else is the specification's.
KuramotoSivashinskyOptions options_on(Index cells) { return {.cells = cells}; }

template <class T>
Batch<double> simulate(const Batch<double>& x,
                       const Batch<double>& u0,
                       Index steps = KuramotoSivashinskyOptions{}.steps) {
  Batch<T> y(u0.rows(), u0.cols());
  Workspace work;
  auto options = options_on(u0.rows());
  options.steps = steps;
  AnyProblem<T>(problems::kuramoto_sivashinsky(options))
      .forward(x.cast<T>(), u0.cast<T>(), y, work);
  return y.template cast<double>();
}

/// Losses and gradients of `problems()`, each at its column of x.
template <class T>
struct Observed {
  Samples<T> data = problems().cast<T>();

  void operator()(std::span<const Index> active,
                  BatchIn<T> x,
                  VectorOut<double> loss,
                  BatchOut<T> gradient) const {
    const std::vector<Index> some(active.begin(), active.end());
    Physics at{AnyProblem<T>(
        problems::kuramoto_sivashinsky(options_on(data.y.rows())))};
    const auto found =
        at.losses(x, data.given(Eigen::all, some), data.y(Eigen::all, some));
    loss = found.loss, gradient = found.x_bar;
  }
};

void check_operators(const Json& entry) {
  const auto near = EntryTolerance(entry).array();
  const auto op = operators(options_on(vector(entry.at("G")).size()));
  EXPECT_TRUE(near(op.k, vector(entry.at("k"))));
  EXPECT_TRUE(near(op.linear, vector(entry.at("linear"))));
  EXPECT_TRUE(near(op.exp, vector(entry.at("exp"))));
  EXPECT_TRUE(near(op.dt_phi1, vector(entry.at("dt_phi1"))));
  EXPECT_TRUE(near(op.dt_phi2, vector(entry.at("dt_phi2"))));
  EXPECT_TRUE(near(op.forcing, vector(entry.at("G"))));
}

template <class T>
void check_problems(const Json& entry) {
  const auto near = within<T>(entry, 1e-3);
  const auto s = problems_of(entry);
  EXPECT_TRUE(near(simulate<T>(s.x, s.given), s.y));
}

template <class T>
void check_intermediate(const Json& entry) {
  const auto near = within<T>(entry, 1e-3);
  const auto s = problems();
  const Vector<T> x = s.x.col(0).cast<T>(), u0 = s.given.col(0).cast<T>();
  const std::vector<Index> steps = entry.at("steps");
  ASSERT_FALSE(steps.empty());
  ASSERT_GE(*std::min_element(steps.begin(), steps.end()), 1);
  auto options = options_on(u0.rows());
  options.steps = *std::max_element(steps.begin(), steps.end());
  const Batch<T> path = kuramoto_sivashinsky_trajectory<T>(options, x, u0);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Index k = steps[i];
    const Vector<double> expected = vector(entry.at("u").at(i));
    EXPECT_TRUE(near(path.col(k), expected)) << "after " << k;
    EXPECT_TRUE(near(
        simulate<T>(s.x.leftCols(1), s.given.leftCols(1), k).col(0), expected))
        << "after " << k;
  }
}

template <class T>
void check_gradients(const Json& entry) {
  const auto loss_near = within<T>(entry, 2e-4);
  const auto gradient_near = within<T>(entry, 1e-2);
  const Observed<T> objective;
  const Index n = objective.data.count();
  std::vector<Index> all(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) all[static_cast<std::size_t>(i)] = i;
  ASSERT_FALSE(entry.at("points").empty());
  for (const Json& point : entry.at("points")) {
    const T alpha = static_cast<T>(number(point.at("alpha")));
    const T beta = static_cast<T>(number(point.at("beta")));
    SCOPED_TRACE(fmt::format("alpha {}, beta {}", alpha, beta));
    Batch<T> x(2, n), gradient(2, n);
    x.row(0).setConstant(alpha), x.row(1).setConstant(beta);
    Vector<double> loss(n);
    objective(all, x, loss, gradient);
    EXPECT_TRUE(loss_near(loss, vector(point.at("loss"))));
    EXPECT_TRUE(gradient_near(gradient, columns(point.at("gradient"))));
  }
}

template <class T>
void check_special(const Json& entry) {
  const auto near = within<T>(entry, 1e-3);
  ASSERT_FALSE(entry.at("cases").empty());
  for (const Json& c : entry.at("cases")) {
    SCOPED_TRACE(c.at("case").get<std::string>());
    const Vector<double> x =
        Eigen::Vector2d(number(c.at("alpha")), number(c.at("beta")));
    const Batch<double> y = simulate<T>(x, vector(c.at("u0")));
    if (c.value("finite", true)) {
      EXPECT_TRUE(near(y.col(0), vector(c.at("uT"))));
    } else {
      // Where it ran out of range, and all that follows from there.
      EXPECT_TRUE(y.array().isNaN().all());
    }
  }
}

/// One problem per run, in order; rounding decides the path after iterate 3.
void check_runs(const Json& entry) {
  const Samples<double> all = problems();
  const Json runs = entry.at("runs");
  ASSERT_EQ(static_cast<Index>(runs.size()), all.count());
  for (Index i = 0; i < all.count(); ++i) {
    SCOPED_TRACE(fmt::format("problem {}", i));
    const Json stored = runs.at(static_cast<std::size_t>(i));
    const auto run = record_bfgs(
        Observed<double>{
            {.x = all.x.col(i), .y = all.y.col(i), .given = all.given.col(i)}},
        vector(stored.at("x0"), 2),
        stored.at("gtol"));
    expect_run(entry, stored, run, 3);
    const auto solved = [&](const Vector<double>& x) {
      return (x - all.x.col(i)).cwiseAbs().maxCoeff() < 1e-3;
    };
    EXPECT_EQ(solved(run.iterates.rightCols<1>()),
              solved(vector(stored.at("x"), 2)));
  }
}

template <Precision precision>
void check_jpo(const Json& entry) {
  const Samples<double> data = problems();
  expect_jpo(kId,
             entry,
             {.inputs = {Field::given, Field::observations},
              .network = nn::vgg({.channels = 2,
                                  .grid = {.columns = data.given.rows()},
                                  .features = {32, 32, 64, 64},
                                  .hidden = {64, 64}}),
              .rate = 1e-3,
              .last_matrix = 0.1,
              .output_scale = 0.25,
              .single = {.loss = 2e-4, .gradient = 1e-2}},
             problems::kuramoto_sivashinsky(options_on(data.given.rows())),
             data,
             precision);
}

TEST(KuramotoSivashinskyReference, EveryEntry) {
  const std::map<std::string, EntryCheck> checks = {
      {"clip_percentile_*", check_clip},
      {"boundary_loss", check_boundary},
      {"bfgs_test_functions", check_test_functions},
      {"operators", check_operators},
      {"problems", in_both(check_problems<float>, check_problems<double>)},
      {"intermediate",
       in_both(check_intermediate<float>, check_intermediate<double>)},
      {"loss_and_gradient",
       in_both(check_gradients<float>, check_gradients<double>)},
      {"special_states", in_both(check_special<float>, check_special<double>)},
      {"bfgs", check_runs},
      {"jpo_g2s",
       in_both(check_jpo<Precision::f32>, check_jpo<Precision::f64>)}};
  const std::set<std::string> of_networks = {"surrogate_unet"};
  check_entries(kId, checks, of_networks);
}

}  // namespace
}  // namespace physinv::test
