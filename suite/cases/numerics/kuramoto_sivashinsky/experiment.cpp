// The solver behind the Kuramoto-Sivashinsky experiment: what accuracy costs,
// how chaos grows with time, and where it breaks.
#include <cmath>
#include <vector>

#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "suite/cases/numerics/common/sweep_report.h"
#include "suite/cases/numerics/kuramoto_sivashinsky/sweep.h"
#include "suite/diagnostics/growth.h"
#include "suite/diagnostics/stability_sweep.h"
#include "suite/harness/registry.h"

namespace physinv::ks_numerics {
namespace {

ProblemRecipe solver(double end, Index steps, Index cells = 128) {
  return problems::kuramoto_sivashinsky(
      {.cells = cells,
       .time_step = end / static_cast<double>(steps),
       .steps = steps});
}

/// Up to `end` with the experiment's step of 1/4.
ProblemRecipe until(double end) {
  return solver(end, static_cast<Index>(std::lround(4 * end)));
}

ProblemRecipe stepping(double dt) {
  return solver(kEnd, static_cast<Index>(std::lround(kEnd / dt)));
}
ProblemRecipe gridded(double cells) {
  return solver(kEnd, 100, static_cast<Index>(cells));
}

}  // namespace

// Claims ask while static objects of other sources are made: all of it is here.
const std::vector<NumericalParameter>& parameters() {
  static const SweepAxis steps{
      "time step", {1, 0.5, 0.25, 0.125, 0.0625, 0.03125, 0.015625}, true};
  static const SweepAxis cells{"cells", {64, 128, 256}, true};
  // Longer steps than 1/16 are not yet in the regime of small steps.
  static const std::vector<NumericalParameter>& all = declare_parameters(
      kName,
      {{.id = "step",
        .title = "Time step, until t = 25",
        .axis = steps,
        .problems = along(steps, stepping),
        .reference = solver(kEnd, 12800),
        .order = 2,
        .regime = 4,
        .samples = 16},
       {.id = "cells",
        .title = "Cells, steps of 1/4",
        .axis = cells,
        .problems = along(cells, gridded),
        .reference = gridded(512),
        .samples = 16},
       batch_parameter(stepping(0.25), 64, stepping(0.015625))});
  return all;
}

namespace {

// ---- methods --------------------------------------------------------------

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
  return {kStability, {stability_sweep(parameters), stability_sweep(horizons)}};
}

std::vector<Row> rows(Index n) {
  std::vector<Row> all = accuracy_rows(n);
  all.push_back({.methods = {"growth", kStability}, .n = {n}, .seeds = {0}});
  return all;
}

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = kName,
      .title = "Numerics of the Kuramoto-Sivashinsky solver",
      .citation = {.paper = "jpo", .where = "App. D.3"},
      .problem = until(kEnd),
      .setting = {},  // nothing is learned here
      .profiles = {{.name = "smoke", .rows = rows(4)},
                   {.name = "quick", .rows = rows(8)},
                   {.name = "paper", .rows = rows(32)}},
      .methods = {accuracy_method(parameters()),
                  growth_method(),
                  stability_method()},
  });
}

}  // namespace physinv::ks_numerics
