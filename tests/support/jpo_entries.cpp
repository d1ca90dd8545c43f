#include "tests/support/jpo_entries.h"

#include <gtest/gtest.h>

#include "baselines/boundary_loss.h"
#include "optimizers/steps/clip_percentile.h"
#include "tests/optimizers/functions.h"
#include "tests/support/run_reference.h"

namespace physinv::test {

void check_clip(const Json& entry) {
  static const std::string kKind = "clip_percentile_";
  const std::string name = entry.at("name");
  ASSERT_TRUE(name.starts_with(kKind)) << name;
  const double percentile = std::stod(name.substr(kKind.size()));
  Batch<double> g = columns(entry.at("input"));
  ASSERT_GE(g.cols(), 1);
  const auto near = EntryTolerance(entry).array();
  ClipPercentile clip(percentile / 100);
  EXPECT_TRUE(near(clip.operator()<double>(g), number(entry.at("threshold"))));
  EXPECT_TRUE(
      near(Eigen::Map<const Vector<double>>(
               clip.norms().data(), static_cast<Index>(clip.norms().size())),
           vector(entry.at("norms"))));
  EXPECT_TRUE(near(g, columns(entry.at("output"))));
}

void check_boundary(const Json& entry) {
  const auto near = EntryTolerance(entry).array();
  const Batch<double> x = columns(entry.at("xi"));
  // M7: gamma = 20.
  const BoundaryLoss wall(vector(entry.at("lo"), x.rows()),
                          vector(entry.at("hi"), x.rows()),
                          setting(entry, "gamma", "gamma", 20));
  Vector<double> loss = Vector<double>::Zero(x.cols());
  Batch<double> g = Batch<double>::Zero(x.rows(), x.cols());
  wall.add(x, 1, loss, g);
  EXPECT_TRUE(near(loss, vector(entry.at("value"))));
  EXPECT_TRUE(near(g, columns(entry.at("gradient"))));
}

void check_test_functions(const Json& entry) {
  const auto compared =
      static_cast<Index>(setting(entry, "compared", "for the first", 8));
  for (const Json& stored : entry.at("runs")) {
    const std::string name = stored.at("function");
    SCOPED_TRACE(name + " from " + stored.at("x0").dump());
    const auto run = record_bfgs(
        ClosedForm{name}, vector(stored.at("x0")), stored.at("gtol"));
    expect_run(entry, stored, run, compared);
    if (name != "rosenbrock" && stored.at("status") == 0) {
      EXPECT_EQ(run.iterations, stored.at("iterations").get<Index>());
    }
  }
}

}  // namespace physinv::test
