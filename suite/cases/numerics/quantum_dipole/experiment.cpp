// The quantum dipole under controls from nothing to 1e6, with steps from tiny
// to huge: Cayley's step is unitary for all of them.
#include "problems/quantum_dipole/quantum_dipole.h"
#include "suite/cases/numerics/common/atlas.h"

namespace physinv {
namespace {

const SweepAxis kSize{"size of the control", decades(-6, 6, 0.5), true};
const SweepAxis kStep{"time step", decades(-8, 4, 1), true};

const bool kRegistered = register_atlas(
    {.name = "numerics/quantum-dipole",
     .title = "Numerics of the quantum dipole",
     .source = {.paper = "hig", .where = "Sec. 3.3"},
     .sweeps = {{.id = "controls",
                 .title = "Size of the control and time step (384 steps)",
                 .x = kSize,
                 .y = kStep,
                 .point = [](double size, double) { return uneven(384, size); },
                 .problems = along(kStep,
                                   [](double dt) {
                                     return problem<QuantumDipole>(
                                         "quantum_dipole", {.dt = dt});
                                   }),
                 // psi has norm 1 and 384 roundings: differences over 0.1 are
                 // known to 1e-12.
                 .zero = 1e-7}}});

}  // namespace
}  // namespace physinv
