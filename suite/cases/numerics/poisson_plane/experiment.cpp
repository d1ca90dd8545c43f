// Poisson's equation on planes of 8 to 256 cells a side: sources of any size,
// and what conjugate gradients, which the authors took, make of it.
#include <numbers>

#include "problems/poisson/poisson.h"
#include "suite/cases/numerics/common/atlas.h"
#include "suite/core/math.h"

namespace physinv::numerics::poisson_plane {
namespace {

ProblemRecipe plane(double side) {
  return problems::poisson(
      {.rows = static_cast<Index>(side), .columns = static_cast<Index>(side)});
}

/// Conjugate gradients until this relative residual, on 64 x 64 cells.
ProblemRecipe iterated(double relative) {
  return problems::poisson({.relative = relative});
}

/// The eigenvector of wave numbers (k, k).
Vector<double> wave(double size, Index side, Index k) {
  const Vector<double> line = Vector<double>::NullaryExpr(side, [=](Index i) {
    return math::sin(double((i + 1) * k) * std::numbers::pi / double(side + 1));
  });
  return (size * line * line.transpose()).reshaped();
}

const SweepAxis kSizes{"size", decades(-300, 300, 200), true};
const SweepAxis kSides{"cells a side", {8, 16, 32, 64, 128, 256}, true};

Sweep sources(const char* id, const char* title, bool rough) {
  return {.id = id,
          .title = title,
          .x = kSizes,
          .y = kSides,
          .point =
              [rough](double size, double side) {
                const auto cells = static_cast<Index>(side);
                return wave(size, cells, rough ? cells : 1);
              },
          .problems = along(kSides, plane)};
}

const SweepAxis kResiduals{
    "relative residual", {1e-1, 1e-3, 1e-5, 1e-8, 1e-12}, true};

}  // namespace

void add_experiments(Registry& r) {
  add_atlas(
      r,
      {.name = "numerics/poisson-plane",
       .title = "Numerics of Poisson's equation on planes",
       .citation = {.paper = "sip", .where = "App. B.2"},
       .sweeps = {sources(
                      "smoothest", "Smoothest source: size and grid", false),
                  sources("roughest", "Roughest source: size and grid", true)},
       .parameters = {{.id = "residual",
                       .title = "Conjugate gradients",
                       .axis = kResiduals,
                       .problems = along(kResiduals, iterated),
                       .reference = plane(64),
                       .repetitions = 3},
                      batch_parameter(plane(64), 32, iterated(1e-13))}});
}

}  // namespace physinv::numerics::poisson_plane
