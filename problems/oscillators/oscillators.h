/// Two coupled nonlinear oscillators: which control brings the pair back to
/// where it started? (Half-inverse gradients, Sec. 3.1, App. B.2 and C,
/// Figs. 2, 5, 6, 12, 13; the form is that of the authors' code.)
///
///   x1' = p1,  p1' = -x1 + g (x2 - x1)^3
///   x2' = p2,  p2' = -x2 - g (x2 - x1)^3 + C u_n
///
/// Classical Runge-Kutta of order 4, u_n constant during step n. One step's
/// derivative needs of the trajectory only w_i = 3 g (x2 - x1)^2 at its four
/// stages, so these are what a linearization keeps. Cotangents run backwards
/// through the stages: one row for a gradient, four for the Jacobian.
///
/// Unknown x: the controls u_0 .. u_{steps-1}. Given: the state (x1, x2, p1,
/// p2) at the start. Observation y: the state at the end; wanted is the given
/// state. Loss: sum of squares, no 1/2. vjp, Jacobian: exact.
///
/// Controls beyond the stability of the integrator overflow and give
/// non-finite numbers in their own column only.
#pragma once

#include <array>

#include "suite/core/recipe.h"

namespace physinv {

struct OscillatorsOptions {
  Index steps = 96;
  double dt = 0.125;      ///< time step
  double coupling = 1.0;  ///< g; 4 reads the paper's Hamiltonian literally
  double control = 3.0;   ///< C
  /// Controls of labelled samples are N(0, deviation^2).
  double deviation = 0.3;

  auto fields() const {
    return std::tuple{field("steps", steps),
                      field("dt", dt),
                      field("coupling", coupling),
                      field("control", control),
                      field("deviation", deviation)};
  }
};

/// One time step: y = state after it, a = dy / d state (4 x 4), b = dy / du.
struct OscillatorsStep {
  std::array<double, 4> y{};
  std::array<std::array<double, 4>, 4> a{};  ///< a[row][column]
  std::array<double, 4> b{};
};

/// Through the same kernels as `Oscillators<T>`.
template <class T>
OscillatorsStep oscillators_step(const std::array<double, 4>& state,
                                 double u,
                                 const OscillatorsOptions& options = {});

namespace problems {
ProblemRecipe oscillators(const OscillatorsOptions& options = {});
}

}  // namespace physinv
