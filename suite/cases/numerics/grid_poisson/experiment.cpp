// Poisson's equation with potentials of any size, from the smoothest to the
// roughest.
#include <numbers>

#include "problems/grid_poisson/grid_poisson.h"
#include "suite/cases/numerics/common/atlas.h"
#include "suite/cases/numerics/grid_poisson/closed_form.h"
#include "suite/core/math.h"

namespace physinv::numerics::grid_poisson {
namespace {

/// The eigenvector of wave numbers (k, k), which L shrinks or stretches.
Vector<double> potential(double size, double k) {
  return Vector<double>::NullaryExpr(kPoissonCells, [=](Index at) {
    const auto wave = [=](Index i) {
      return math::sin(double(i + 1) * k * std::numbers::pi /
                       double(kPoissonSide + 1));
    };
    return size * wave(at / kPoissonSide) * wave(at % kPoissonSide);
  });
}

const ProblemRecipe kPoisson = problems::grid_poisson();

}  // namespace

void add_experiments(Registry& r) {
  add_atlas(r,
            {.name = "numerics/poisson",
             .title = "Numerics of the Poisson problem",
             .citation = {.paper = "hig", .where = "Sec. 3.2"},
             .sweeps = {{.id = "potentials",
                         .title = "Size and wave number of the potential",
                         .x = {"size", decades(-150, 150, 10), true},
                         .y = {"wave number", {1, 2, 3, 4, 5, 6, 7, 8}},
                         .point = potential,
                         .problems = {kPoisson}}},
             .parameters = {batch_parameter(
                 kPoisson, 256, {}, grid_poisson_closed_form())}});
}

}  // namespace physinv::numerics::grid_poisson
