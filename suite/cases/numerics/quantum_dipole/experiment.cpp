// The quantum dipole under controls from nothing to 1e8, with steps from tiny
// to huge: Cayley's step is unitary for all of them.
#include <cmath>

#include "problems/quantum_dipole/quantum_dipole.h"
#include "suite/cases/numerics/common/atlas.h"

namespace physinv {
namespace {

const SweepAxis kSize{"size of the control", decades(-6, 8, 0.5), true};
const SweepAxis kStep{"time step", decades(-8, 4, 1), true};

Vector<double> control(double size, double) {
  return Vector<double>::NullaryExpr(
      384, [=](Index k) { return size * std::cos(1.1 * double(k)); });
}

std::vector<ProblemRecipe> steps() {
  std::vector<ProblemRecipe> all;
  for (const double dt : kStep.values)
    all.push_back(problem<QuantumDipole>("quantum_dipole", {.dt = dt}));
  return all;
}

const bool kRegistered = register_atlas(
    {.name = "numerics/quantum-dipole",
     .title = "Numerics of the quantum dipole",
     .source = {.paper = "hig", .where = "Sec. 3.3"},
     .sweeps = {{.id = "controls",
                 .title = "Size of the control and time step (384 steps)",
                 .x = kSize,
                 .y = kStep,
                 .point = control,
                 .problems = steps()}}});

}  // namespace
}  // namespace physinv
