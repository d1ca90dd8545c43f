/// One bit pattern for what is not a number.
///
/// x86-64 makes a NaN with its sign set of 0 / 0 and inf - inf, ARM one
/// without, and which of two operands gives a NaN its other bits is the
/// processor's and the compiler's to choose. What is stored, hashed or compared
/// by its bits goes through here first.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>

#include "suite/core/batch.h"

namespace physinv {

/// Whether one of the `count` values is a NaN.
template <std::floating_point T>
bool has_nan(const T* values, Index count) {
  bool any = false;
  for (Index i = 0; i < count; ++i) any |= values[i] != values[i];
  return any;
}

/// Every NaN becomes quiet_NaN(): positive, without further bits.
template <std::floating_point T>
void unify_nan(T* values, Index count) {
  if (!has_nan(values, count)) return;
  for (Index i = 0; i < count; ++i)
    if (std::isnan(values[i])) values[i] = std::numeric_limits<T>::quiet_NaN();
}

/// The same of a vector or matrix whose entries lie side by side.
template <class M>
void unify_nan(M& m) {
  unify_nan(m.data(), static_cast<Index>(m.size()));
}

}  // namespace physinv
