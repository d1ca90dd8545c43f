/// On how many problems a method ends below, at or above another.
#pragma once

#include <limits>

#include "suite/core/batch.h"

namespace physinv {

/// When losses a and b, of the other, count as equal: where they are the same,
/// where |a - b| <= relative |b|, and where both are below `both_below`, as
/// tolerances alone decide which is lower.
struct Equality {
  double relative = 0;
  double both_below = -std::numeric_limits<double>::infinity();

  bool operator==(const Equality&) const = default;
  static const Equality strict;
  static const Equality tol;   ///< |a - b| <= 1e-6 |b|
  static const Equality band;  ///< 1e-3 |b|, nothing where solvers end at kinks
};
inline constexpr Equality Equality::strict{};
inline constexpr Equality Equality::tol{.relative = 1e-6};
inline constexpr Equality Equality::band{.relative = 1e-3};

/// Shares of problems on which a method ends below, at or above another.
struct Shares {
  double better = 0, equal = 0, worse = 0;
  /// f_N = N_better / N + N_equal / (2 N).
  double f() const { return better + 0.5 * equal; }
};

/// A loss that is not finite is worse; a finite one is better than another that
/// is not. Sizes must agree and be positive.
Shares compare_losses(VectorIn<double> loss,
                      VectorIn<double> other,
                      Equality equality);

}  // namespace physinv
