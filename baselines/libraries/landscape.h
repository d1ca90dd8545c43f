/// Functions of one or two unknowns on which solvers differ: walls of infinity
/// and NaN, kinks, plateaus, gradients that are wrong, scales, bounds.
///
///   loss = y = scale f(x)
///
/// Unknown x. Given: the lower and the upper bounds, if there are any.
/// Observation y (1). Loss: y itself, so that it may be negative or not finite.
/// vjp: as the function has it, which may be wrong. No solution is known.
#pragma once

#include <string>
#include <vector>

#include "suite/core/recipe.h"

namespace libraries {

using physinv::Index;

struct LandscapeOptions {
  std::string function = "rosenbrock";         ///< one of landscape.cpp
  std::vector<double> start = {-1.2, 1};       ///< as many as unknowns
  double scale = 1;                            ///< of loss and gradient
  std::vector<double> lower = {}, upper = {};  ///< bounds; empty: none

  auto fields() const {
    return std::tuple{physinv::field("function", function),
                      physinv::field("start", start),
                      physinv::if_changed(physinv::field("scale", scale)),
                      physinv::if_changed(physinv::field("lower", lower)),
                      physinv::if_changed(physinv::field("upper", upper))};
  }
};

physinv::ProblemRecipe landscape(const LandscapeOptions& options);

}  // namespace libraries
