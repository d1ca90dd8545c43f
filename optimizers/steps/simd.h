/// One register's worth of numbers for the update rules. A step must give a
/// number the same bits wherever it stands in the vector, so the tail goes
/// through the same register operations as everything else.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>

#ifdef __AVX__
#include <immintrin.h>
#endif

#include "suite/core/batch.h"

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
  static V multiply_add(V a, V b, V c) {
#ifdef __FMA__
    if constexpr (sizeof(T) == 4) {
      return (V)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
    } else {
      return (V)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
    }
#else
    for (Index l = 0; l < kLanes; ++l) c[l] = std::fma(a[l], b[l], c[l]);
    return c;
#endif
  }
  static V all(T s) { return s - V{}; }
  /// v where |v| >= tiny (or NaN), else 0.
  static V without_tiny(V v, T tiny) {
    return (v < all(tiny)) & (v > all(-tiny)) ? V{} : v;
  }
  /// The compiler may not vectorise std::sqrt, which has to set errno.
  static V root(V v) {
#ifdef __AVX__
    if constexpr (sizeof(T) == 4) {
      return (V)_mm256_sqrt_ps((__m256)v);
    } else {
      return (V)_mm256_sqrt_pd((__m256d)v);
    }
#else
    for (Index l = 0; l < kLanes; ++l) v[l] = std::sqrt(v[l]);
    return v;
#endif
  }
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
