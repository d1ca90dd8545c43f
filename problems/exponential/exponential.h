/// The exponential of one number: gradients shrink with it, over five orders of
/// magnitude. (Scale-invariant physics training, App. C.2.)
///
///   y = exp(x),  x uniform in (-12, 0]
///
/// Unknown x (1). Given: nothing. Observation y (1). Loss: half the square.
/// vjp, Jacobian: exact, exp(x). Hessian: 2 exp(2 x) - y exp(x). invert: log y,
/// the only solution; a guess that y already is the exponential of stays, so
/// that nothing pushes it any more.
///
/// exp(x) is infinite beyond x = 88 in float, 709 in double. A column of x that
/// is not finite gives NaN or infinity in its own column only; y < 0 has no
/// inverse and gives NaN.
#pragma once

#include "suite/core/recipe.h"

namespace physinv {

struct ExponentialOptions {
  double lowest = -12;  ///< of the unknowns, the highest is 0

  auto fields() const { return std::tuple{field("lowest", lowest)}; }
};

namespace problems {
ProblemRecipe exponential(const ExponentialOptions& options = {});
}

}  // namespace physinv
