/// Quantum dipole: which control u(t) steers a particle in a box from its
/// ground state to a given superposition of excited states? (Half-inverse
/// gradients, Sec. 3.3, App. B.4, Figs. 4, 8-11; form of the authors' code.)
///
///   i d_t psi = (-d_xx + u(t) x) psi  on (0, 2), psi = 0 at the walls
///
/// 14 inner points x_j = j dx, dx = 2/15. With A_n = dt/2 (H0 + u_n diag(x)),
/// H0 = tridiag(-1, 2, -1) / dx^2, one step is Cayley's, hence unitary:
///
///   psi_{n+1} = 2 M_n^{-1} psi_n - psi_n,  M_n = 1 + i A_n
///
/// M_n is symmetric and tridiagonal with off-diagonal -i r, r = dt / (2 dx^2).
/// Elimination from both walls to the middle (two short chains instead of a
/// long one) needs 14 reciprocal pivots p_j, kept as e_j = i r p_j; the real
/// part of 1/p_j is at least 1, so no control needs pivoting. Rows of
/// cotangents c go backwards through the same factorisation:
///
///   w = M_n^{-1} c,  dy/du_n = -(i dt/2) sum_j w_j x_j (psi_{n+1} + psi_n)_j,
///   c <- 2 w - c
///
/// and so does conj(psi), which gives the trajectory back without having been
/// stored. One row makes a gradient, 14 complex rows the Jacobian.
///
/// Unknown x: the controls u_0 .. u_{steps-1}. Given: nothing. Observation y:
/// psi at the end, row 2 point + part (real, imaginary); wanted is a target
/// state t. Loss: 1 - |<t, psi>|^2. Inner products have no dx. vjp, Jacobian:
/// exact; Jacobians are computed in double whatever T is, as an inverse power
/// multiplies what so many steps would leave of float. project: norm
/// conservation, J^T psi = 0.
///
/// Controls that are not finite, or whose square overflows, give non-finite
/// numbers in their own column only.
#pragma once

#include <vector>

#include "suite/core/recipe.h"

namespace physinv {

inline constexpr Index kQuantumPoints = 14;  ///< between the walls

struct QuantumDipoleOptions {
  Index steps = 384;
  double dt = 0.05;  ///< time step
  /// Value of the loss as |psi - <t, psi> t|^2: the same for states of norm 1,
  /// without the cancellation that stops 1 - |<t, psi>|^2 near 1e-6 in float.
  /// The gradient stays -2 <t, psi> t, that of the other form: along psi the
  /// two differ, where no control acts.
  bool accurate_loss = false;
  /// Controls of the start and of labelled samples are N(0, deviation^2):
  /// without any control the third eigenstate is out of reach.
  double deviation = 0.08;
  /// start() is zero control: for networks whose output is the control.
  bool zero_start = false;
  /// Angles of the first targets, (f1, f2) = (cos, sin); the rest is drawn.
  std::vector<double> angles = {};

  auto fields() const {
    return std::tuple{field("steps", steps),
                      field("dt", dt),
                      field("accurate_loss", accurate_loss),
                      field("deviation", deviation),
                      field("zero_start", zero_start),
                      field("angles", angles)};
  }
};

/// psi_k at the inner points, k = 1 .. 14, of norm 1: sin(pi k j / 15) scaled.
Vector<double> quantum_eigenstate(int k);
/// E_k = 4 / dx^2 sin^2(pi k / 30)
double quantum_energy(int k);
/// A real state as an observation.
Vector<double> quantum_observation(const Vector<double>& real_state);

/// (|<psi_k, psi>| - |<psi_k, t>|)^2 of states y and targets: k = 2 is the
/// paper's low-energy loss, k = 3 its high-energy loss.
template <class T>
void quantum_level_loss(int k,
                        BatchIn<T> y,
                        BatchIn<T> target,
                        VectorOut<double> loss);

namespace problems {
ProblemRecipe quantum_dipole(const QuantumDipoleOptions& options = {});
}

}  // namespace physinv
