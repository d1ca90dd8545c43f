// The coupled oscillators under controls from nothing to far beyond what their
// integrator stands, with steps from fine to coarse.
#include <cmath>

#include "problems/oscillators/oscillators.h"
#include "suite/cases/numerics/common/atlas.h"

namespace physinv {
namespace {

const SweepAxis kSize{"size of the control", decades(-6, 8, 0.5), true};
const SweepAxis kStep{"time step", decades(-3, 1, 0.25), true};

/// Alternates in sign and size, so that no symmetry helps.
Vector<double> control(double size, double) {
  return Vector<double>::NullaryExpr(
      96, [=](Index k) { return size * std::cos(1.1 * double(k)); });
}

std::vector<ProblemRecipe> steps() {
  std::vector<ProblemRecipe> all;
  for (const double dt : kStep.values)
    all.push_back(problem<Oscillators>("oscillators", {.dt = dt}));
  return all;
}

const bool kRegistered = register_atlas(
    {.name = "numerics/oscillators",
     .title = "Numerics of the oscillators",
     .source = {.paper = "hig", .where = "Sec. 3.1"},
     .sweeps = {{.id = "controls",
                 .title = "Size of the control and time step (96 steps)",
                 .x = kSize,
                 .y = kStep,
                 .point = control,
                 .problems = steps(),
                 .examples = 2}}});

}  // namespace
}  // namespace physinv
