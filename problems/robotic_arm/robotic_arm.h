/// Robotic arm: which base height and joint angles bring the tip to a given
/// point? (Joint parameter optimization, App. D.5, Fig. 25; the arm is that of
/// the neural-adjoint paper, Ren, Padilla and Malof 2020.)
///
/// The base slides on a vertical rail, three links l_k turn in the plane. Each
/// angle is relative, and both earlier ones are subtracted from the last:
///
///   phi_1 = x_2,  phi_2 = x_3 - x_2,  phi_3 = x_4 - x_3 - x_2
///   y = (sum_k l_k cos phi_k,  x_1 + sum_k l_k sin phi_k)
///
/// With d_k = dy / dphi_k = l_k (-sin phi_k, cos phi_k) the columns of the
/// Jacobian are (0, 1), d_1 - d_2 - d_3, d_2 - d_3, d_3: three sines and
/// cosines give y and all derivatives.
///
/// Unknown x: base height, three angles (4). Given: nothing. Observation y:
/// the tip (2). Two equations for four unknowns: a solution is judged by its
/// loss. vjp, Jacobian: exact. Stretched poses are singular; at x = 0 no
/// unknown moves the tip sideways.
///
/// A column of x that is not finite gives NaN in its own column only.
#pragma once

#include <array>

#include "suite/core/recipe.h"

namespace physinv {

struct RoboticArmOptions {
  std::array<double, 3> links = {0.5, 0.5, 1.0};
  /// Prior of the unknowns, normal; its mean is the first guess.
  std::array<double, 4> mean = {0.0, 0.0, 0.0, 0.0};
  std::array<double, 4> deviation = {0.25, 0.5, 0.5, 0.5};

  auto fields() const {
    return std::tuple{field("links", links),
                      field("mean", mean),
                      field("deviation", deviation)};
  }
};

/// Base, the two joints between the links, and the tip. For plots and checks.
std::array<std::array<double, 2>, 4> arm_joints(
    const std::array<double, 4>& x, const RoboticArmOptions& options = {});

namespace problems {
ProblemRecipe robotic_arm(const RoboticArmOptions& options = {});
}

}  // namespace physinv
