/// One register's worth of numbers for the update rules. A step must give a
/// number the same bits wherever it stands in the vector, so the tail goes
/// through the same register operations as everything else.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>

#include "suite/core/lanes.h"

namespace physinv::steps {

template <class T>
struct Register {
  static constexpr Index kLanes = 32 / static_cast<Index>(sizeof(T));
  typedef T V __attribute__((vector_size(32)));

  static V load(const T* p, Index count = kLanes) {
    V v{};
    std::memcpy(&v, p, static_cast<std::size_t>(count) * sizeof(T));
    return v;
  }
  static void store(T* p, V v, Index count = kLanes) {
    std::memcpy(p, &v, static_cast<std::size_t>(count) * sizeof(T));
  }
  /// a * b + c with one rounding, in the body as in the tail.
  static V multiply_add(V a, V b, V c) { return fma_lanes(a, b, c); }
  static V all(T s) { return s - V{}; }
  /// v where |v| >= tiny (or NaN), else 0.
  static V without_tiny(V v, T tiny) {
    return ((v < all(tiny)) & (v > all(-tiny))) ? V{} : v;
  }
  /// The compiler may not vectorise std::sqrt, which has to set errno.
  static V root(V v) { return sqrt_lanes(v); }
};

/// body(i, lanes) for consecutive pieces of [0, size). The body should capture
/// by value: it is inlined, and its constants then stay in registers.
template <class T, class F>
[[gnu::always_inline]] inline void for_registers(Index size, F body) {
  constexpr Index w = Register<T>::kLanes;
  Index i = 0;
  for (; i + w <= size; i += w) body(i, std::integral_constant<Index, w>{});
  if (i < size) body(i, size - i);
}

}  // namespace physinv::steps
