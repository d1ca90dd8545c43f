// Every entry of jpo-robotic-arm, each checked by what carries it out.

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <functional>
#include <map>

#include "baselines/boundary_loss.h"
#include "optimizers/gradient_descent.h"
#include "problems/robotic_arm/robotic_arm.h"
#include "tests/optimizers/functions.h"
#include "tests/support/jpo_reference.h"
#include "tests/support/run_reference.h"

namespace physinv::test {
namespace {

const std::string kId = "jpo-robotic-arm";

/// The losses of arms that should reach targets.col(i), for the solvers.
struct Reaching {
  Batch<double> targets;

  void operator()(std::span<const Index> active,
                  BatchIn<double> x,
                  VectorOut<double> loss,
                  BatchOut<double> gradient) const {
    const RoboticArm<double> arm;
    const Index n = x.cols();
    Batch<double> y(2, n), target(2, n), y_bar(2, n);
    for (Index k = 0; k < n; ++k)
      target.col(k) = targets.col(active[static_cast<std::size_t>(k)]);
    Tape tape;
    Workspace work;
    arm.linearize(x, Batch<double>(0, n), y, tape);
    arm.loss(y, target, loss);
    arm.loss_gradient(y, target, y_bar);
    arm.pullback(tape, y_bar, gradient, work);
  }
};

void check_clip(const Json& entry) {
  Batch<double> g = columns(entry.at("input"));
  const auto near = EntryTolerance(entry).array();
  EXPECT_TRUE(near(g.colwise().norm().transpose(), vector(entry.at("norms"))));
  const double tau = ClipPercentile(0.9).operator()<double>(g);
  EXPECT_TRUE(near(tau, number(entry.at("threshold"))));
  EXPECT_TRUE(near(g, columns(entry.at("output"))));
}

void check_boundary(const Json& entry) {
  const auto near = EntryTolerance(entry).array();
  const Batch<double> x = columns(entry.at("xi"));
  const BoundaryLoss wall(vector(entry.at("lo")), vector(entry.at("hi")));
  Vector<double> loss = Vector<double>::Zero(x.cols());
  Batch<double> g = Batch<double>::Zero(x.rows(), x.cols());
  wall.add(x, 1, loss, g);
  EXPECT_TRUE(near(loss, vector(entry.at("value"))));
  EXPECT_TRUE(near(g, columns(entry.at("gradient"))));
}

void check_test_functions(const Json& entry) {
  for (const Json& stored : entry.at("runs")) {
    const auto name = stored.at("function").get<std::string>();
    SCOPED_TRACE(name + " from " + stored.at("x0").dump());
    const auto run = record_bfgs(
        ClosedForm{name}, vector(stored.at("x0")), stored.at("gtol"));
    expect_run(entry, stored, run, 8);
    if (name != "rosenbrock") {
      EXPECT_EQ(run.iterations, stored.at("iterations").get<Index>());
    }
  }
}

/// One forward and one gradient evaluation; sines and cosines of the angles
/// as T rounds them.
template <class T>
void check_case(const Json& c, const Comparator& same) {
  const RoboticArm<T> arm;
  const Batch<T> x = vector(c.at("x")).cast<T>(), given(0, 1);
  const Batch<T> target = vector(c.at("target")).cast<T>();
  Batch<T> y(2, 1), forward(2, 1), y_bar(2, 1), x_bar(4, 1), j(8, 1);
  Vector<double> loss(1);
  Tape tape;
  Workspace work;
  arm.linearize(x, given, y, tape);
  arm.loss(y, target, loss);
  arm.loss_gradient(y, target, y_bar);
  arm.pullback(tape, y_bar, x_bar, work);
  arm.jacobian(x, given, j, work);
  arm.forward(x, given, forward, work);
  const Batch<double> jacobian =
      Eigen::Map<const Eigen::Matrix<T, 2, 4>>(j.data())
          .template cast<double>();
  const Vector<double> sigma = jacobian.jacobiSvd().singularValues();
  EXPECT_EQ(forward, y);
  EXPECT_TRUE(same(y, vector(c.at("tip"))));
  EXPECT_TRUE(same(loss, Vector<double>::Constant(1, number(c.at("loss")))));
  EXPECT_TRUE(same(x_bar, vector(c.at("gradient"))));
  EXPECT_TRUE(same(jacobian, rows(c.at("jacobian"))));
  EXPECT_TRUE(same(sigma, vector(c.at("singular_values"))));
}

void check_forward(const Json& entry) {
  ASSERT_FALSE(entry.at("cases").empty());
  for (const Json& c : entry.at("cases")) {
    SCOPED_TRACE(c.at("x").dump());
    check_case<double>(c, EntryTolerance(entry).array());
    check_case<float>(c, {1e-4, 1e-6});
  }
}

void check_bfgs(const Json& entry) {
  for (const Json& stored : entry.at("runs")) {
    SCOPED_TRACE(stored.at("target").dump());
    const auto run = record_bfgs(Reaching{vector(stored.at("target"))},
                                 vector(stored.at("x0")),
                                 stored.at("gtol"));
    expect_run(entry, stored, run, 1);
  }
}

void check_descent(const Json& entry) {
  const auto near = EntryTolerance(entry).array();
  const Json& xs = entry.at("x_after_iteration");
  const Json& losses = entry.at("loss_after_iteration");
  std::vector<Batch<double>> x;
  std::vector<Vector<double>> loss;
  GradientDescent gd(
      {.step_tolerance = 1e-10, .maxiter = static_cast<Index>(xs.size()) - 1});
  drive(gd,
        Reaching{columns(entry.at("targets"))},
        columns(xs.at(0)),
        [&](const GradientDescent& g) {
          if (g.accepted().empty()) return;
          x.push_back(g.x());
          loss.push_back(g.loss());
        });
  ASSERT_EQ(x.size(), xs.size());
  for (std::size_t k = 0; k < xs.size(); ++k) {
    EXPECT_TRUE(near(x[k], columns(xs[k]))) << "iteration " << k;
    EXPECT_TRUE(near(loss[k], vector(losses[k]))) << "iteration " << k;
  }
  const Vector<double> evaluations = vector(entry.at("evaluations"));
  for (Index i = 0; i < evaluations.size(); ++i)
    EXPECT_EQ(gd.evaluations()[static_cast<std::size_t>(i)], evaluations(i));
}

void check_jpo(const Json& entry) {
  const Batch<double> targets = columns(entry.at("targets"));
  const Samples<double> s{{}, targets, Batch<double>(0, targets.cols())};
  for (const Precision precision : {Precision::f64, Precision::f32}) {
    SCOPED_TRACE(to_string(precision));
    expect_jpo<RoboticArm>(entry,
                           {.inputs = {Field::observations},
                            .network = {.hidden = {128, 128, 128}},
                            .parameters = 33924,
                            .rate = 1e-3},
                           s,
                           precision);
  }
}

TEST(RoboticArmReference, EveryEntry) {
  const std::map<std::string, std::function<void(const Json&)>> checks = {
      {"clip_percentile_90", check_clip},
      {"boundary_loss", check_boundary},
      {"bfgs_test_functions", check_test_functions},
      {"forward", check_forward},
      {"bfgs", check_bfgs},
      {"gd_adaptive", check_descent},
      {"jpo_mlp", check_jpo}};
  const Json file = load_reference(kId);
  ASSERT_FALSE(file.at("entries").empty());
  for (const Json& entry : file.at("entries")) {
    const auto name = entry.at("name").get<std::string>();
    SCOPED_TRACE(name);
    ASSERT_TRUE(checks.contains(name)) << "no test reads this entry";
    checks.at(name)(entry);
  }
}

}  // namespace
}  // namespace physinv::test
