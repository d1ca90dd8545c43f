/// Powers of a stacked Jacobian (Schnell, Holl, Thuerey 2022, "Half-Inverse
/// Gradients for Physical Deep Learning", eqs. 5, 6, 21, 22).
///
/// J = U diag(s) V^T is m x p, g the gradient of the loss by the m outputs:
///
///   update = s_max^beta V diag(s_i^kappa if s_i > cut, else 0) U^T g = J^T v
///   v = s_max^beta U diag(s_i^(kappa - 1) if s_i > cut, else 0) U^T g
///
/// kappa = -1/2 is the half-inverse, -1 Gauss-Newton, 1 plain descent.
#pragma once

#include <algorithm>
#include <limits>
#include <string_view>

#include "suite/core/batch.h"
#include "suite/core/options.h"

namespace physinv::hig {

inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

struct Power {
  double kappa = -0.5;    ///< in [-1, 1]
  double tau = 1e-6;      ///< truncation, see `absolute`
  double beta = 0;        ///< exponent of the prefactor s_max^beta
  bool absolute = false;  ///< cut = tau instead of tau s_max

  double cut(double s_max) const { return absolute ? tau : tau * s_max; }

  auto fields() const {
    return std::tuple{
        field("kappa", kappa),
        field("tau", tau),
        field("beta", beta),
        word("cut", absolute ? "absolute" : "relative", absolute)};
  }
};

enum class Ending {
  ok,
  zero,       ///< g = 0 or nothing kept: the update is exactly 0
  nonfinite,  ///< an input is not finite (seen before any factorisation)
  stalled,    ///< the iteration for the singular values did not end
};

constexpr std::string_view to_string(Ending e) {
  constexpr std::string_view names[] = {"ok", "zero", "nonfinite", "stalled"};
  return names[static_cast<int>(e)];
}

struct PowerReport {
  Ending ending = Ending::ok;
  double s_max = 0, cut = 0;
  Index kept = 0;
  double smallest_kept = 0;    ///< 0 if nothing is kept
  double largest_dropped = 0;  ///< 0 if nothing is dropped
  double margin = 0;           ///< min |s_i - cut| / cut; infinite for cut = 0
  double norm = 0;             ///< 2-norm of the update
  double norm_bound = 0;       ///< s_max^beta max(kept s^kappa) |g| >= norm
  /// What rounding may have done to the update, relative to `norm` (2-norm,
  /// see error_estimate). Infinite where the kept set itself is in doubt.
  double error = 0;
};

/// Whether the update is known to be accurate.
inline bool proven(const PowerReport& report, double tolerance) {
  return report.ending == Ending::zero ||
         (report.ending == Ending::ok && report.error <= tolerance);
}

/// Eigenpairs of J J^T as far as an update needs them.
struct Spectrum {
  Vector<double> lambda;  ///< s_i^2, in any order, perhaps slightly negative
  Vector<double> c;       ///< U^T g
  double scale = 1;       ///< of J: s_i = scale sqrt(lambda_i)

  /// Model of the perturbation E of diag(lambda) that the computation stands
  /// for, relative to lambda_max: |E_ij| is about slope (s_i + s_j) / s_max,
  /// and tail on top where both i and j are >= tail_begin, elsewhere gram.
  struct Noise {
    double gram = 0, tail = 0, slope = 0;
    Index tail_begin = 0;
    double norm_factor = 1;  ///< |E|_2 over the size of an entry

    /// |E_ii| for s_i = s s_max. Single values err more than their directions:
    /// seen up to 1.5 eps where J is exactly rank-deficient.
    double entry(bool in_tail, double s) const {
      return (in_tail ? tail : std::max(gram, slope)) + 2 * slope * s;
    }
  } noise;

  double s(Index i) const;
  double s_max() const;
};

/// Size of an entry of E between directions of large values for reductions in
/// double of an m x m matrix whose own error is matrix_noise eps (2-norm over
/// 2-norm), and |E|_2 over that size (a random symmetric matrix). Seen for the
/// 2-norm of reduction and QR: 0.3 to 0.7 m^(1/4) eps.
double entry_noise(Index m, double matrix_noise);
double norm_factor(Index m);
/// The same between directions of small values. Rounding is spread over the
/// whole matrix: seen 2.3 to 4.8 |G|_F / m eps, and more only where single
/// rows are all of G, up to a quarter of their diagonal entry.
double small_entry_noise(VectorIn<double> lambda,
                         double largest_diagonal,
                         double matrix_noise);

/// Weights of v in the basis U, v = U weights, and the report of the update.
PowerReport power_weights(const Spectrum& spectrum,
                          const Power& power,
                          VectorOut<double> weights);

}  // namespace physinv::hig
