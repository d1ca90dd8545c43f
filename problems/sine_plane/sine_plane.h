/// A sine and a line, stretched against each other and turned: the
/// two-dimensional test of scale-invariant training (SIP paper, App. B.1, Fig.
/// 5; the division by xi is inside the sine, as in the authors' code: with the
/// printed form most targets have no solution).
///
///   w = R x,  u = (gamma / xi w_1, gamma xi w_2),  y = (sin u_1, u_2),
///   R = [[cos phi, -sin phi], [sin phi, cos phi]]
///
/// Unknown x (2), unbounded. Given: nothing. Observation y (2), uniform in
/// [-1, 1]^2. Loss: half the square. vjp, Jacobian, Hessian: exact. With q = R
/// grad and r = y - y*, the Hessian is diagonal in the turned frame,
///
///   S = (a^2 (cos^2 u_1 - r_1 sin u_1), b^2),  a = gamma / xi, b = gamma xi
///
/// invert: one step of Newton's method from the guess, limited and free of
/// saddles (authors' code): along axis i of the turned frame
///
///   n_i = |q_i / S_i|,  if S_i <= sqrt |S_1 S_2|: n_i = min(n_i, limit /
///   |q_i|) dx = R^T (-sign(q_i) n_i)
///
/// with 0 for quotients by 0. Everything is computed in double, also where T is
/// float: the Hessian's condition number is up to xi^4.
///
/// A column of x that is not finite gives NaN in its own column only.
#pragma once

#include <array>

#include "suite/core/recipe.h"

namespace physinv {

struct SinePlaneOptions {
  double gamma = 10;
  double xi = 1;       ///< stretches one axis, squeezes the other
  double degrees = 0;  ///< phi
  double limit = 0.2;  ///< of the decrease that one axis of a step promises

  auto fields() const {
    return std::tuple{field("gamma", gamma),
                      field("xi", xi),
                      field("degrees", degrees),
                      field("limit", limit)};
  }
};

using Pair = std::array<double, 2>;

/// The exact solution nearest to x; |y_1| beyond 1 counts as 1.
Pair nearest_solution(const SinePlaneOptions& options,
                      const Pair& x,
                      const Pair& y);

/// dx of `invert`.
Pair limited_newton_step(const SinePlaneOptions& options,
                         const Pair& x,
                         const Pair& target);

namespace problems {
ProblemRecipe sine_plane(const SinePlaneOptions& options = {});
}

}  // namespace physinv
