#include "tests/support/jpo_entries.h"

#include <gtest/gtest.h>

#include "baselines/boundary_loss.h"
#include "optimizers/steps/clip_percentile.h"
#include "tests/optimizers/functions.h"
#include "tests/support/run_reference.h"

namespace physinv::test {

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

}  // namespace physinv::test
