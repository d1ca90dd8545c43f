/// Forced Kuramoto-Sivashinsky equation: which forcing alpha and advection
/// beta turn one observed state into a later one? (Joint parameter
/// optimization, Sec. 4, Fig. 5, App. D.3, Figs. 15 to 18.)
///
///   u_t = alpha G(x) - u_xx - u_xxxx - beta u u_x,  periodic
///   G(x) = 0.1 cos x - 0.01 cos(x / 16) (1 - 2 sin(x / 16))
///
/// `cells` centres x_j = (j + 1/2) box / cells, wave numbers k = m / box in
/// cycles: a box of length 2 pi 22 with G stretched, in the usual units.
/// Exponential Runge-Kutta of second order (ETDRK2, Cox and Matthews 2002),
/// no dealiasing; per step of length dt, with L = k^2 - k^4, E = exp(L dt),
/// P1 = dt phi1(L dt), P2 = dt phi2(L dt) and n(u) = -(i k beta / 2) F(u^2):
///
///   a^ = E u^ + P1 (n(u) + alpha G^),   u_new^ = a^ + P2 (n(a) - n(u))
///
/// Unknown x: (alpha, beta) (2). Given: u(0) (`cells`). Observation y: u at
/// the end, t = steps * time_step (`cells`). vjp: exact discrete adjoint.
/// Jacobian: two tangent runs. Perturbations grow 20 to 50 times on the way.
///
/// A run that overflows (large alpha, |beta| beyond about 20) gives NaN in its
/// own column, of y and of every derivative.
///
/// alpha = 0 adds no forcing, and beta = 0 makes `forward` one multiplication
/// of modes per step, to the same values; finite states are assumed to have
/// finite squares then. `skipped_terms` are those of the registers where that
/// is so for every sample: one a step and sample without forcing, two without
/// advection; steps that are simulated again count once.
///
/// Speed: a register of samples at a time (LanesFft), which ends with its last
/// sample; of samples that fill half of one at most, four points of each are
/// side by side (FoursFft), to the same bits. The spectrum of u is the state
/// (etdrk2.h): a step forward takes four real transforms, and so does a step
/// back. For 128 cells and samples a step takes 0.20 us per sample in double
/// and 0.10 us in float with AVX-512 (FFTW, one sample at a time: 0.51 and
/// 0.47), with its gradient 0.62 and 0.31 us (1.5 and 1.4); a single sample
/// takes 0.41 and 0.36 us a step, with its gradient 0.81 and 0.75.
#pragma once

#include <array>
#include <memory>

#include "suite/core/recipe.h"

namespace physinv {

struct KuramotoSivashinskyOptions {
  Index cells = 128;  ///< a power of two, at least 16
  double box = 22.0;  ///< length of the box
  double time_step = 0.25;
  Index steps = 100;
  /// Prior of alpha and of beta, uniform and independent.
  double prior_low = 0.75, prior_high = 1.25;
  std::array<double, 2> start = {1.0, 1.0};  ///< first guess (alpha, beta)
  /// Bytes of states that `linearize` may keep (2e5 per sample in double).
  /// Larger batches keep every sqrt(steps)-th state and simulate again in
  /// between: less than a fifth of the memory, up to half as much time again,
  /// the same bits.
  double tape_budget = 1e8;

  auto fields() const {
    return std::tuple{field("cells", cells),
                      field("box", box),
                      field("time_step", time_step),
                      field("steps", steps),
                      field("prior_low", prior_low),
                      field("prior_high", prior_high),
                      field("start", start),
                      field("tape_budget", tape_budget)};
  }
};

/// The step's multipliers for the modes m = 0 .. cells/2, and G at the cells.
struct KuramotoSivashinskyOperators {
  Vector<double> k;        ///< wave number in cycles, m / box
  Vector<double> linear;   ///< L = k^2 - k^4
  Vector<double> exp;      ///< E = exp(L dt)
  Vector<double> dt_phi1;  ///< P1 = (E - 1) / L
  Vector<double> dt_phi2;  ///< P2 = (E - 1 - L dt) / (L^2 dt)
  Vector<double> forcing;  ///< G(x_j)
};
KuramotoSivashinskyOperators operators(
    const KuramotoSivashinskyOptions& options);

/// The time step.
template <class T>
struct Etdrk2Kernels;

/// What the problem has in addition: derivatives by the initial state.
template <class T>
class StatePullback {
 public:
  virtual ~StatePullback() = default;
  /// `Vjp::pullback` with d/du(0) in given_bar (`cells` rows).
  virtual void pullback_state(const Tape& tape,
                              BatchIn<T> y_bar,
                              BatchOut<T> x_bar,
                              BatchOut<T> given_bar,
                              Workspace& work) const = 0;
};

/// u(x, t) of one sample: column k is the state after k steps, k = 0 .. steps;
/// the first is `given` itself, the last has the bits of `forward`.
template <class T>
Batch<T> kuramoto_sivashinsky_trajectory(
    const KuramotoSivashinskyOptions& options,
    VectorIn<T> x,
    VectorIn<T> given);

namespace problems {
ProblemRecipe kuramoto_sivashinsky(
    const KuramotoSivashinskyOptions& options = {});
}

}  // namespace physinv
