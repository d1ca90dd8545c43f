/// Paired rank tests: does one method end lower than another on the same
/// problems?
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "suite/results/solved_loss.h"

namespace physinv {

/// Decades by which loss `a` lies above `b`, both raised to kEqualLoss;
/// infinite if only one is not finite, 0 if neither is.
double decades_above(double a, double b);

/// Wilcoxon's signed rank test (Biometrics Bulletin 1, 1945) of paired
/// differences, two-sided. Ties (differences of 0) are dropped, equal sizes
/// share their ranks. Of at most 50 differences all signs are counted, else it
/// uses the normal distribution with the variance of shared ranks; the numbers
/// of scipy.stats.wilcoxon, which shares no ranks where it counts.
struct SignedRank {
  std::size_t pairs = 0, below = 0, ties = 0;  ///< below: negative
  double p = 1;                                ///< 1 if there is no difference
  bool down = false;  ///< those below 0 have the larger sum of ranks
  std::size_t above() const { return pairs - below - ties; }
};
SignedRank signed_rank(std::span<const double> differences);

/// Holm's correction (Scand. J. Statist. 6, 1979): for each p the level at
/// which its hypothesis is refused among all of them.
std::vector<double> holm(const std::vector<double>& p);

/// What lies below is called a difference.
inline constexpr double kSignificant = 0.05;

/// "p < 1e-6", "p = 0.03"
std::string p_text(double p);

}  // namespace physinv
