/// A damped pendulum that is seen eight times: how did it start, and how strong
/// is the damping?
///
///   theta'' = -w^2 sin(theta) - c theta',  y = theta at the times of sight
///
/// by the semi-implicit Euler method. Unknown x: angle and speed at the start,
/// damping c (3). Given: the frequency w (1). Observations y: angles (8). vjp:
/// exact, of the discrete steps.
///
/// A column of x that is not finite gives NaN in its own column only.
#pragma once

#include "suite/core/recipe.h"

namespace pendulum {

using namespace physinv;

struct PendulumOptions {
  double interval = 0.5;  ///< between sights, s
  Index substeps = 10;    ///< of an interval

  auto fields() const {
    return std::tuple{field("interval", interval), field("substeps", substeps)};
  }
};

ProblemRecipe pendulum(const PendulumOptions& options = {});

}  // namespace pendulum
