// The quantum dipole under controls from nothing to 1e6, with steps from tiny
// to huge: Cayley's step is unitary for all of them.
#include <fmt/format.h>

#include <cmath>

#include "problems/quantum_dipole/quantum_dipole.h"
#include "suite/cases/numerics/common/atlas.h"

namespace physinv::numerics::quantum_dipole {
namespace {

const SweepAxis kSize{"size of the control", decades(-6, 6, 0.5), true};
const SweepAxis kStep{"time step", decades(-8, 4, 1), true};

/// The experiment's step of 0.05, halved so many times.
ProblemRecipe stepping(double end, int halved) {
  const double dt = std::ldexp(0.05, -halved);
  return problems::quantum_dipole(
      {.steps = static_cast<Index>(std::lround(end / dt)), .dt = dt});
}

/// Energies reach 225: the phases of the highest states turn right over the
/// whole time only with steps of 1e-4. The order shows on a shorter one.
NumericalParameter steps(const char* id,
                         double end,
                         int halvings,
                         double order) {
  NumericalParameter parameter{
      .id = id,
      .title = fmt::format("Time step of Cayley's method, until {}", end),
      .axis = {"time step", {}, true},
      .problems = {},
      .reference = stepping(end, halvings + 3),
      .order = order,
      .samples = 16};
  for (int k = 0; k <= halvings; ++k) {
    parameter.axis.values.push_back(std::ldexp(0.05, -k));
    parameter.problems.push_back(stepping(end, k));
  }
  parameter.regime = parameter.problems.size() - 2;
  return parameter;
}

}  // namespace

void add_experiments(Registry& r) {
  add_atlas(
      r,
      {.name = "numerics/quantum-dipole",
       .title = "Numerics of the quantum dipole",
       .citation = {.paper = "hig", .where = "Sec. 3.3"},
       .sweeps = {{.id = "controls",
                   .title = "Size of the control and time step (384 steps)",
                   .x = kSize,
                   .y = kStep,
                   .point = [](double size,
                               double) { return uneven(384, size); },
                   .problems = along(kStep,
                                     [](double dt) {
                                       return problems::quantum_dipole(
                                           {.dt = dt});
                                     }),
                   // psi has norm 1 and 384 roundings: differences over 0.1 are
                   // known to 1e-12.
                   .zero = 1e-7}},
       .parameters = {
           steps("step", 19.2, 5, 0),
           steps("short", 1.2, 8, 2),
           batch_parameter(stepping(19.2, 0), 64, stepping(19.2, 4))}});
}

}  // namespace physinv::numerics::quantum_dipole
