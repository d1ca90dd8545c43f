// A marker in a periodic flow: any speed, end time and grid, and what its time
// steps cost.
#include <cmath>
#include <numbers>

#include "problems/marker_flow/marker_flow.h"
#include "suite/cases/numerics/common/atlas.h"
#include "suite/core/math.h"

namespace physinv::numerics::marker_flow {
namespace {

ProblemRecipe of_steps(Index steps) {
  return problems::marker_flow({.cells = 32, .steps = steps});
}

/// Two waves for each component, of which no two neighbours have one value: the
/// limiter would be at a kink there.
Vector<double> flow(double speed, Index cells) {
  const Index plane = cells * cells;
  const double turn = 2 * std::numbers::pi / double(cells);
  return Vector<double>::NullaryExpr(2 * plane, [=](Index at) {
    const Index i = at % plane / cells, j = at % cells;
    const auto angle = [=](Index a, Index b, double shift) {
      return std::fma(turn, double(a * i + b * j), shift);
    };
    return speed * (at < plane ? math::cos(angle(2, 1, 0.2)) +
                                     0.3 * math::sin(angle(3, -1, 0))
                               : math::sin(angle(1, 1, 0.5)) +
                                     0.4 * math::cos(angle(-1, 2, 0)));
  });
}

/// At speed 1 on 64 cells a step crosses an eighth of a cell. Air at rest is a
/// kink of the limiter, where the adjoint is that of one side; beyond speed 100
/// kinks are closer than differences can step.
const SweepAxis kSpeeds{"speed", {1e-3, 0.1, 1, 10, 100, 1e7}, true};
const SweepAxis kGrids{"cells a side", {16, 32, 64, 128}, true};
const SweepAxis kTimes{"end time", {0.25, 1, 4, 16}, true};

const SweepAxis kTimeSteps{"time step", {1, 0.5, 0.25, 0.125}, true};

}  // namespace

void add_experiments(Registry& r) {
  add_atlas(
      r,
      {.name = "numerics/marker-flow",
       .title = "Numerics of a marker in a flow",
       .citation = {.paper = "sip", .where = "App. B.4"},
       .sweeps = {{.id = "grids",
                   .title = "Speed and grid, one step",
                   .x = kSpeeds,
                   .y = kGrids,
                   .point =
                       [](double speed, double cells) {
                         return flow(speed, static_cast<Index>(cells));
                       },
                   .problems = along(kGrids,
                                     [](double cells) {
                                       return problems::marker_flow(
                                           {.cells = static_cast<Index>(cells),
                                            .end_time = 0.25,
                                            .steps = 1});
                                     })},
                  {.id = "times",
                   .title = "Speed and end time",
                   .x = kSpeeds,
                   .y = kTimes,
                   .point = [](double speed,
                               double) { return flow(speed, 32); },
                   .problems = along(kTimes,
                                     [](double end_time) {
                                       return problems::marker_flow(
                                           {.cells = 32,
                                            .end_time = end_time,
                                            .steps = static_cast<Index>(
                                                4 * end_time)});
                                     })}},
       .parameters = {{.id = "steps",
                       .title = "Time steps, 32 x 32 cells",
                       .axis = kTimeSteps,
                       .problems = along(kTimeSteps,
                                         [](double step) {
                                           return of_steps(
                                               static_cast<Index>(2 / step));
                                         }),
                       .reference = of_steps(32),
                       .samples = 4,
                       .repetitions = 3}},
       .problem = problems::marker_flow()});
}

}  // namespace physinv::numerics::marker_flow
