// The solver behind the Kuramoto-Sivashinsky experiment: what accuracy costs,
// how chaos grows with time, and where it breaks.
#include <cmath>
#include <vector>

#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "suite/cases/numerics/kuramoto_sivashinsky/sweep.h"
#include "suite/diagnostics/growth.h"
#include "suite/diagnostics/stability_sweep.h"
#include "suite/diagnostics/work_precision.h"
#include "suite/harness/registry.h"

namespace physinv::ks_numerics {
namespace {

ProblemRecipe solver(double end, Index steps) {
  return problem<KuramotoSivashinsky>(
      "kuramoto_sivashinsky",
      {.time_step = end / static_cast<double>(steps), .steps = steps});
}

/// Up to `end` with the experiment's step of 1/4.
ProblemRecipe until(double end) {
  return solver(end, static_cast<Index>(std::lround(4 * end)));
}

// ---- methods --------------------------------------------------------------

Method work_precision_method() {
  Method method{"work-precision", {}};
  for (const Index steps : kSteps)
    method.chain.push_back(
        work_precision({.name = stage_name(steps),
                        .problem = solver(kEnd, steps),
                        .reference = solver(kEnd, kReferenceSteps)}));
  return method;
}

Method growth_method() {
  GrowthOptions options;
  for (const double end : spaced(5, 100, 20))
    options.horizons.push_back({end, until(end)});
  return {"growth", {growth(options)}};
}

Method stability_method() {
  StabilitySweepOptions parameters{
      .name = "parameters", .problems = {until(kEnd)}, .examples = 2};
  for (const double beta : kBeta.values)
    for (const double alpha : kAlpha.values)
      parameters.points.push_back({0, Eigen::Vector2d(alpha, beta)});
  StabilitySweepOptions horizons{.name = "horizons", .examples = 2};
  for (const double end : kTime.values) {
    for (const double beta : kLowBeta.values)
      horizons.points.push_back({static_cast<Index>(horizons.problems.size()),
                                 Eigen::Vector2d(1, beta)});
    horizons.problems.push_back(until(end));
  }
  return {"stability",
          {stability_sweep(parameters), stability_sweep(horizons)}};
}

std::vector<Row> rows(Index n) {
  return {{.methods = {"work-precision"},
           .n = {n},
           .seeds = {0},
           .precision = Precision::f64},
          {.methods = {"work-precision"},
           .n = {n},
           .seeds = {0},
           .precision = Precision::f32},
          {.methods = {"growth", "stability"}, .n = {n}, .seeds = {0}}};
}

/// Nothing is learned here.
const Setting kNoNetworks;

const auto kRegistered = register_experiment({
    .name = kName,
    .title = "Numerics of the Kuramoto-Sivashinsky solver",
    .source = {.paper = "jpo", .where = "App. D.3"},
    .problem = until(kEnd),
    .setting = kNoNetworks,
    .profiles = {{.name = "smoke", .rows = rows(4)},
                 {.name = "quick", .rows = rows(8)},
                 {.name = "paper", .rows = rows(32)}},
    .methods = {work_precision_method(), growth_method(), stability_method()},
});

}  // namespace
}  // namespace physinv::ks_numerics
