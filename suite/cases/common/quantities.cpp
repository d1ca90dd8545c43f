// Names of the columns of the problems' arrays, as the headers of the problems
// have them. All are without a unit but angles. A field names its indices, the
// last of them the fastest.
#include "suite/harness/quantities.h"

#include <utility>

#include "suite/cases/common/folders.h"

namespace physinv {

namespace {

/// By problem.
const std::pair<const char*, Quantities> kQuantities[] = {
    {"billiards",
     {.unknowns = {"v_x, v_y"}, .observations = {"x, y"}, .given = {"x, y"}}},
    {"exponential", {.unknowns = {"x"}, .observations = {"y"}, .given = {}}},
    {"grid_poisson",
     {.unknowns = {"potential(i, j)"},
      .observations = {"source(i, j)"},
      .given = {}}},
    {"heat",
     {.unknowns = {"temperature before(i, j)"},
      .observations = {"temperature(i, j)"},
      .given = {}}},
    {"kuramoto_sivashinsky",
     {.unknowns = {"alpha, beta"},
      .observations = {"u at the end(cell)"},
      .given = {"u at the start(cell)"}}},
    {"marker_flow",
     {.unknowns = {"velocity at the start(component, i, j)"},
      .observations = {"density at the end(i, j)"},
      .given = {"density at the start(i, j)"}}},
    {"navier_stokes",
     {.unknowns = {"z_0, z_1, z_2"},
      .observations = {"velocity at the end(component, i, j)"},
      .given = {"velocity at the start(component, i, j)"}}},
    {"noisy_absolute",
     {.unknowns = {"x"},
      .observations = {"loss"},
      .given = {"gamma, x*, lambda, amplitudes(term), frequencies(term), "
                "phases(term)"}}},
    {"oscillators",
     {.unknowns = {"u(step)"},
      .observations = {"x1, x2, p1, p2"},
      .given = {"x1, x2, p1, p2"}}},
    {"poisson",
     {.unknowns = {"source(i, j)"},
      .observations = {"potential(i, j)"},
      .given = {}}},
    {"quantum_dipole",
     {.unknowns = {"u(step)"},
      .observations = {"psi(point, part)"},
      .given = {}}},
    {"robotic_arm",
     {.unknowns = {"height, angle_1, angle_2, angle_3", "1, rad, rad, rad"},
      .observations = {"x, y"},
      .given = {}}},
    {"scaled_output",
     {.unknowns = {"x_1, x_2"}, .observations = {"z_1, z_2"}, .given = {"t"}}},
    {"scaling",
     {.unknowns = {"x1, x2"}, .observations = {"y1, y2"}, .given = {"alpha"}}},
    {"sine_plane",
     {.unknowns = {"x_1, x_2"}, .observations = {"y_1, y_2"}, .given = {}}},
    {"wave_packet",
     {.unknowns = {"xi"},
      .observations = {"signal(sample)"},
      .given = {"disturbance(sample)"}}}};

}  // namespace

void name_quantities() {
  for (const auto& [problem, quantities] : kQuantities)
    register_quantities(problem, quantities);
}

}  // namespace physinv
