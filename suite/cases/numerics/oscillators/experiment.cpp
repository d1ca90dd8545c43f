// The coupled oscillators under controls from nothing to far beyond what their
// integrator can follow, with steps from fine to coarse.
#include <cmath>

#include "problems/oscillators/oscillators.h"
#include "suite/cases/numerics/common/atlas.h"

namespace physinv::numerics::oscillators {
namespace {

const SweepAxis kSize{"size of the control", decades(-6, 8, 0.5), true};
const SweepAxis kStep{"time step", decades(-3, 1, 0.25), true};

constexpr double kEnd = 12;

ProblemRecipe stepping(double dt) {
  return problems::oscillators(
      {.steps = static_cast<Index>(std::lround(kEnd / dt)), .dt = dt});
}

const SweepAxis kSteps{
    "time step", {0.5, 0.25, 0.125, 0.0625, 0.03125, 0.015625}, true};

}  // namespace

void add_experiments(Registry& r) {
  add_atlas(
      r,
      {.name = "numerics/oscillators",
       .title = "Numerics of the oscillators",
       .citation = {.paper = "hig", .where = "Sec. 3.1"},
       .sweeps = {{.id = "controls",
                   .title = "Size of the control and time step (96 steps)",
                   .x = kSize,
                   .y = kStep,
                   .point = [](double size,
                               double) { return uneven(96, size); },
                   .problems = along(kStep,
                                     [](double dt) {
                                       return problems::oscillators({.dt = dt});
                                     }),
                   .examples = 2}},
       .parameters = {
           {.id = "step",
            .title = "Time step of the Runge-Kutta method, until t = 12",
            .axis = kSteps,
            .problems = along(kSteps, stepping),
            .reference = stepping(1.0 / 512),
            .order = 4,
            .regime = 3,
            .samples = 64},
           batch_parameter(stepping(0.125), 256, stepping(1.0 / 128))}});
}

}  // namespace physinv::numerics::oscillators
