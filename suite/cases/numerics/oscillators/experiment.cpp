// The coupled oscillators under controls from nothing to far beyond what their
// integrator stands, with steps from fine to coarse.
#include "problems/oscillators/oscillators.h"
#include "suite/cases/numerics/common/atlas.h"

namespace physinv {
namespace {

const SweepAxis kSize{"size of the control", decades(-6, 8, 0.5), true};
const SweepAxis kStep{"time step", decades(-3, 1, 0.25), true};

const bool kRegistered = register_atlas(
    {.name = "numerics/oscillators",
     .title = "Numerics of the oscillators",
     .source = {.paper = "hig", .where = "Sec. 3.1"},
     .sweeps = {{.id = "controls",
                 .title = "Size of the control and time step (96 steps)",
                 .x = kSize,
                 .y = kStep,
                 .point = [](double size, double) { return uneven(96, size); },
                 .problems = along(kStep,
                                   [](double dt) {
                                     return problem<Oscillators>("oscillators",
                                                                 {.dt = dt});
                                   }),
                 .examples = 2}}});

}  // namespace
}  // namespace physinv
