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

#include "suite/core/gradient_projection.h"
#include "suite/core/problem.h"
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
  /// start() is no control at all: for networks whose output is the control.
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

template <class T>
class QuantumDipole final : public Problem<T>,
                            public Vjp<T>,
                            public Jacobian<T>,
                            public GradientProjection<T> {
 public:
  using Options = QuantumDipoleOptions;
  explicit QuantumDipole(const Options& options = {});

  Shape shape() const override {
    return {options_.steps, 2 * kQuantumPoints, 0};
  }
  /// Small random controls, always the same; or none (`zero_start`).
  Vector<double> start() const override;

  /// Targets f1 psi_2 + f2 psi_3, (f1, f2) uniform on the circle; no truth.
  Samples<double> sample(Index first,
                         Index count,
                         const Rng& rng) const override;
  /// Random controls, and the states they lead to.
  Samples<double> sample_labelled(Index first,
                                  Index count,
                                  const Rng& rng) const override;

  void forward(BatchIn<T> x,
               BatchIn<T> given,
               BatchOut<T> y,
               Workspace& work) const override;
  /// Keeps controls and final states; the pullback goes back from there.
  void linearize(BatchIn<T> x,
                 BatchIn<T> given,
                 BatchOut<T> y,
                 Tape& tape) const override;
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override;
  void jacobian(BatchIn<T> x,
                BatchIn<T> given,
                BatchOut<T> j,
                Workspace& work) const override;

  void loss(BatchIn<T> y,
            BatchIn<T> target,
            VectorOut<double> loss) const override;
  /// -2 <t, psi> t
  void loss_gradient(BatchIn<T> y,
                     BatchIn<T> target,
                     BatchOut<T> y_bar) const override;

  /// y_bar - psi Re<psi, y_bar>. Once trained, nearly all of the gradient is
  /// that part.
  void project(BatchIn<T> y, BatchOut<T> y_bar) const override;

  /// (|<psi_k, psi>| - |<psi_k, t>|)^2: k = 2 is the paper's low-energy loss,
  /// k = 3 its high-energy loss.
  void level_loss(int k,
                  BatchIn<T> y,
                  BatchIn<T> target,
                  VectorOut<double> loss) const;

  double operations() const override {
    return 480.0 * static_cast<double>(options_.steps);
  }

  const Options& options() const { return options_; }

 private:
  Options options_;
};

extern template class QuantumDipole<float>;
extern template class QuantumDipole<double>;

}  // namespace physinv
