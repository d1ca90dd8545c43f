// Every entry of jpo-robotic-arm, each checked by what carries it out.

#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "problems/robotic_arm/robotic_arm.h"
#include "suite/core/any_problem.h"
#include "suite/nn/mlp.h"
#include "tests/support/jpo_entries.h"
#include "tests/support/jpo_reference.h"
#include "tests/support/physics.h"
#include "tests/support/run_reference.h"
#include "tests/support/singular_values.h"

namespace physinv::test {
namespace {

const std::string kId = "jpo-robotic-arm";

/// One forward and one gradient evaluation; sines and cosines of the angles
/// as T rounds them.
template <class T>
void check_case(const Json& c, const Comparator& same) {
  Physics at{AnyProblem<T>(problems::robotic_arm())};
  const Batch<T> x = vector(c.at("x"), 4).cast<T>(), given(0, 1);
  const Batch<T> target = vector(c.at("target"), 2).cast<T>();
  const auto [y, loss, x_bar] = at.losses(x, given, target);
  const Batch<double> jacobian =
      at.matrix(at.jacobian(x, given), 0).template cast<double>();
  const Vector<double> sigma = jacobi_singular_values(jacobian).s;
  EXPECT_EQ(at.forward(x, given), y);
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

/// Only the first iterate can be compared (M9).
void check_bfgs(const Json& entry) {
  for (const Json& stored : entry.at("runs")) {
    SCOPED_TRACE(stored.at("target").dump());
    const auto run = record_bfgs(
        Matching{vector(stored.at("target"), 2), problems::robotic_arm()},
        vector(stored.at("x0"), 4),
        stored.at("gtol"));
    expect_run(entry, stored, run, 1);
  }
}

void check_arm_descent(const Json& entry) {
  const Matching at{columns(entry.at("targets"), 2), problems::robotic_arm()};
  // Section 3: gtol.
  check_descent(entry, at, 4, at.targets.cols(), 1e-10);
}

void check_jpo(const Json& entry) {
  const auto sizes = layer_sizes(entry, {2, 128, 128, 128, 4});
  const Batch<double> targets = columns(entry.at("targets"), 2);
  const Samples<double> s{{}, targets, Batch<double>(0, targets.cols())};
  for (const Precision precision : {Precision::f64, Precision::f32}) {
    SCOPED_TRACE(to_string(precision));
    expect_jpo(
        kId,
        entry,
        {.inputs = {Field::observations},
         .network = nn::mlp({.hidden = {sizes.begin() + 1, sizes.end() - 1}}),
         .rate = 1e-3},
        problems::robotic_arm(),
        s,
        precision);
  }
}

TEST(RoboticArmReference, EveryEntry) {
  const std::map<std::string, EntryCheck> checks = {
      {"clip_percentile_*", check_clip},
      {"boundary_loss", check_boundary},
      {"bfgs_test_functions", check_test_functions},
      {"forward", check_forward},
      {"bfgs", check_bfgs},
      {"gd_adaptive", check_arm_descent},
      {"jpo_mlp", check_jpo}};
  check_entries(kId, checks);
}

}  // namespace
}  // namespace physinv::test
