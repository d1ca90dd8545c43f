/// Two numbers, of which the second is seen through a small factor: the
/// simplest physics that spoils the conditioning of a fit. (Half-inverse
/// gradients, Secs. 2.1, 2.2, App. B.1, Fig. 1.)
///
///   z = (x_1, gamma x_2),  wanted z = (sin 6 t, cos 9 t)
///
/// Unknown x: the output of a network (2). Given: the point t in [-1, 1]; it
/// does not enter z. Observation: z (2). Loss: half the sum of squares. vjp,
/// Jacobian: exact and constant, diag(1, gamma).
///
/// What is not finite stays in its own column.
#pragma once

#include "suite/core/recipe.h"

namespace physinv {

struct ScaledOutputOptions {
  double gamma = 0.01;  ///< 1 is well, 0.01 ill conditioned

  auto fields() const { return std::tuple{field("gamma", gamma)}; }
};

namespace problems {
ProblemRecipe scaled_output(const ScaledOutputOptions& options = {});
}

}  // namespace physinv
