// A sine and a line, stretched against each other: from the flat of the sine to
// arguments of which no digit is left.
#include <numbers>

#include "problems/sine_plane/sine_plane.h"
#include "suite/cases/numerics/common/atlas.h"
#include "suite/evidence/series.h"

namespace physinv::numerics::sine_plane {
namespace {

ProblemRecipe stretched(double xi) { return problems::sine_plane({.xi = xi}); }

const SweepAxis kStretches{"xi", {1, 2, 4, 8, 16, 32}, true};
/// Extrema of the sine at odd quarters, its zeros at whole halves.
const SweepAxis kTurns{"turns of the sine", spaced(-1, 1, 17), false};
const SweepAxis kSizes{"size", decades(-300, 300, 20), true};

}  // namespace

void add_experiments(Registry& r) {
  add_atlas(
      r,
      {.name = "numerics/sine",
       .title = "Numerics of the sine",
       .citation = {.paper = "sip", .where = "App. B.1"},
       .sweeps = {{.id = "turns",
                   .title = "Turns of the sine and stretch",
                   .x = kTurns,
                   .y = kStretches,
                   .point = [](double turns, double xi) -> Vector<double> {
                     const double a = SinePlaneOptions{}.gamma / xi;
                     return Eigen::Vector2d(2 * std::numbers::pi * turns / a,
                                            0.1);
                   },
                   .problems = along(kStretches, stretched)},
                  {.id = "sizes",
                   .title = "Size of the unknowns and stretch",
                   .x = kSizes,
                   .y = kStretches,
                   .point = [](double size, double) { return uneven(2, size); },
                   .problems = along(kStretches, stretched)}},
       .parameters = {batch_parameter(stretched(4), 1024, stretched(4))}});
}

}  // namespace physinv::numerics::sine_plane
