/// Integers of floating-point numbers. What C++ leaves undefined (NaN,
/// infinities, values that the type does not hold) is another integer on each
/// processor: of NaN x86-64 makes the least one, ARM 0.
#pragma once

#include <concepts>
#include <limits>

namespace physinv {

/// The whole part of `value`, towards 0; the nearest that I holds where it is
/// out of range, 0 for NaN.
template <std::integral I>
constexpr I whole_part(double value) {
  using Limits = std::numeric_limits<I>;
  // One more than the largest, a power of two: exact, which max() may not be.
  constexpr double kEnd = 2.0 * static_cast<double>(Limits::max() / 2 + 1);
  if (value >= kEnd) return Limits::max();
  // Above -1 the whole part is 0.
  constexpr double kLeast = static_cast<double>(Limits::min());
  if (value <= kLeast) return Limits::min();
  return value == value ? static_cast<I>(value) : I{0};
}

}  // namespace physinv
