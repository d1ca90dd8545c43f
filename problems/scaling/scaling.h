/// Two numbers, one of them scaled and perhaps squared. (Physics-based deep
/// learning, chapter "Scale-invariance and inversion".)
///
///   y = (x1, alpha x2^power),  power 1 or 2
///
/// Unknown x (2). Given: alpha (1), at first the listed ones, then uniform in
/// [1, 5). Observation y (2): 0, as the chapter's. Loss: the square |y - y*|^2
/// or half of it.
///
/// vjp, Jacobian, Hessian: exact. invert: the root nearest to the guess, whose
/// sign decides, that of a zero too; a negative square has none, and 0 comes
/// nearest. Closed steps: exact for every x2, with power 2 at x2 = 0 too if
/// y* = 0: -x2 / 3 (Newton) and -x2 / 2 (inverse gradient).
///
/// A column of x that is not finite gives NaN in its own column only.
#pragma once

#include <array>
#include <vector>

#include "suite/core/recipe.h"

namespace physinv {

struct ScalingOptions {
  std::vector<double> scales = {1};  ///< alpha of the first problems, not 0
  int power = 1;                     ///< of x2
  bool half = false;                 ///< loss: half the square
  std::array<double, 2> start = {0.5, 0.85};

  auto fields() const {
    return std::tuple{field("scales", scales),
                      field("power", power),
                      field("half", half),
                      field("start", start)};
  }
};

namespace problems {
ProblemRecipe scaling(const ScalingOptions& options = {});
}

}  // namespace physinv
