/// Absolute distance under Fourier noise (joint parameter optimization, Eq. 2
/// and Sec. 2): the loss landscape in which the paper counts how often noisy
/// gradients point the right way.
///
///   L(x) = lambda |x - x*| - sum_j A_j cos(w_j x + phi_j)
///   dL/dx = lambda sign(x - x*) + sum_j A_j w_j sin(w_j x + phi_j)
///
/// sign(0) = 0. The noise level is a = sqrt(sum_j (A_j w_j)^2), the
/// signal-to-noise ratio lambda / a.
///
/// Unknown x (1). Given: gamma, x*, lambda, A, w, phi (3 + 3 terms); gamma is
/// what a network would see, x* a function of it. Observation y: the loss
/// itself (1), so `loss` is y - target: how far above x* an x lies, less than
/// 0 where the noise digs deeper. vjp: exact. Without terms the noise costs
/// nothing.
///
/// A column of x that is not finite gives NaN in its own column only.
#pragma once

#include "suite/core/recipe.h"

namespace physinv {

/// What x* is.
enum class Solution : std::uint8_t {
  zero,    ///< 0, the same for all
  linear,  ///< 10 gamma
  sine,    ///< sin(2 gamma)
};

constexpr std::string_view to_string(Solution solution) {
  constexpr std::string_view kNames[] = {"zero", "10*gamma", "sin(2*gamma)"};
  return kNames[static_cast<std::size_t>(solution)];
}

struct NoisyAbsoluteOptions {
  Solution solution = Solution::sine;
  double gamma = 2;  ///< gamma ~ U(-gamma, gamma)
  Index terms = 32;  ///< of the noise; w ~ U(omega), phi ~ U(0, 2 pi)
  double omega_min = 1, omega_max = 50;
  double level = 1;    ///< a; A ~ U(0, 1), then rescaled to this level
  double decades = 0;  ///< a = level 10^U(-decades, decades)
  double snr = 1;      ///< lambda = snr a

  auto fields() const {
    return std::tuple{field("solution", solution),
                      field("gamma", gamma),
                      field("terms", terms),
                      field("omega", omega_min, omega_max),
                      field("level", level),
                      field("decades", decades),
                      field("snr", snr)};
  }
};

/// sqrt(sum_j (A_j w_j)^2).
double noise_level(VectorIn<double> amplitude, VectorIn<double> omega);

namespace problems {
ProblemRecipe noisy_absolute(const NoisyAbsoluteOptions& options = {});
}

}  // namespace physinv
