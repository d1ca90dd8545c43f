/// A unit for numbers whose squares would leave the range.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace physinv {

/// A power of two in whose units numbers of up to `largest` have squares that
/// neither overflow nor vanish: 1 where they do not anyway, so that nothing
/// changes, else near `largest`. An even power: its root is one as well, and
/// dividing by it is exact.
template <class T>
T unit_of(T largest) {
  constexpr int kFar = std::numeric_limits<T>::max_exponent * 3 / 10;
  constexpr int kMost = std::numeric_limits<T>::max_exponent - 4;
  int exponent = 0;
  if (std::isfinite(largest)) std::frexp(largest, &exponent);
  if (std::abs(exponent) <= kFar) return 1;
  return std::ldexp(T(1), std::clamp(exponent / 2 * 2, -kMost, kMost));
}

}  // namespace physinv
