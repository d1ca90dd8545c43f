/// A blast of air in a closed box with obstacles, seen later in the upper half:
/// where was it, and how strong? (Joint parameter optimization, Sec. 4, Fig. 6,
/// App. D.4, Figs. 19 to 24.)
///
///   du/dt + u grad u = -grad p,  div u = 0,  numerical diffusion only
///
/// Staggered grid, MacCormack advection with a limiter, exact projection
/// (problems/fluid). A blast exp(-((x-x0)^2 + (y-y0)^2) / (2 width^2)) (vx, vy)
/// joins a random flow at t = 0.
///
/// Unknown x: z (3), x0 = box / 2 (1 + t0), vx = speed t1, vy = speed (1 + t2),
/// t = tanh z of the first `bounded` unknowns, of the others z itself. Given:
/// the initial velocity at the cells' centres (component, i, j). Observation y:
/// the final one in the upper half, j from cells / 2. Index j is the fastest.
/// `sample` hides the initial flow of the lower half, so that the truth has a
/// loss; `sample_labelled` shows it. Both draw the same flows from the same
/// stream.
///
/// vjp: exact discrete adjoint. Jacobian: three tangent runs. The map is
/// continuous and has kinks everywhere (limiter, cells), some 1e-5 in z apart.
///
/// Numbers that are not finite, or beyond 1e6, give NaN in their own column.
///
/// Speed: eight samples side by side, each looking where its own flow takes it;
/// the pressure by a sparse factor shared by all of them and all steps. A
/// sample's forward pass takes 1.0 ms in float and 1.2 in double, its gradient
/// 3.3 and 4.2 (PyTorch, 8 to 32 of them together: 11 and 15, 22 and 37).
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "problems/fluid/box_projection.h"
#include "suite/core/recipe.h"

namespace physinv {

struct NavierStokesOptions {
  Index cells = 64;  ///< per side, even
  double box = 100;  ///< length of a side
  double end_time = 56;
  Index steps = 28;
  std::vector<fluid::Obstacle> obstacles = {
      {12, 22, 24, 29}, {42, 52, 24, 29}, {27, 37, 38, 44}};
  double height = 20, width = 8;  ///< of the blast: y0 and standard deviation
  double speed = 5;               ///< of the unknowns' scaling
  Index bounded = 1;              ///< so many unknowns pass through tanh
  double noise = 0.5;             ///< standard deviation of the initial flow
  /// Of the truth, uniform: x0 in box times, vx and vy in speed times.
  std::array<double, 2> x0 = {0.15, 0.85}, vx = {-1, 1}, vy = {0, 2};
  /// Bytes of states that `linearize` may keep (4e6 per sample in double).
  /// Larger batches are simulated again, a register of samples at a time, to
  /// the same bits.
  double tape_budget = 1.5e8;

  auto fields() const {
    return std::tuple{field("cells", cells),
                      field("box", box),
                      field("end_time", end_time),
                      field("steps", steps),
                      field("obstacles", obstacles),
                      field("height", height),
                      field("width", width),
                      field("speed", speed),
                      field("noise", noise),
                      field("x0", x0),
                      field("vx", vx),
                      field("vy", vy),
                      field("tape_budget", tape_budget),
                      if_changed(field("bounded", bounded))};
  }
};

namespace problems {
ProblemRecipe navier_stokes(const NavierStokesOptions& options = {});
}

}  // namespace physinv
