// The quantum dipole under controls from nothing to 1e6, with steps from tiny
// to huge: Cayley's step is unitary for all of them.
#include <cmath>

#include "problems/quantum_dipole/quantum_dipole.h"
#include "suite/cases/numerics/common/atlas.h"

namespace physinv {
namespace {

const SweepAxis kSize{"size of the control", decades(-6, 6, 0.5), true};
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
                 .problems = steps(),
                 // psi has norm 1 and 384 roundings: differences over 0.1 are
                 // known to 1e-12.
                 .zero = 1e-7}}});

}  // namespace
}  // namespace physinv
