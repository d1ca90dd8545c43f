/// Short vectors as GCC and clang know them: element-wise arithmetic, one
/// operation per instruction, the same bits in every lane.
#pragma once

#include <cstring>
#include <type_traits>

#include "suite/core/lanes.h"

namespace physinv::nn {

template <class T, int kBytes>
struct VectorOf {
  typedef T type __attribute__((vector_size(kBytes)));
};

/// kBytes of T in one register.
template <class T, int kBytes>
using Simd = typename VectorOf<T, kBytes>::type;

inline constexpr int kNarrow = 32;
#ifdef PHYSINV_AVX512
inline constexpr int kWide = 64;
#else
inline constexpr int kWide = 32;
#endif

template <class V, class T>
inline V load(const T* p) {
  V v;
  std::memcpy(&v, p, sizeof(V));
  return v;
}

template <class V, class T>
inline void store(T* p, V v) {
  std::memcpy(p, &v, sizeof(V));
}

template <class V, class T>
inline V broadcast(T s) {
  return s - V{};  // unlike V{} + s, keeps the sign of a zero
}

/// A vector of twice as many lanes.
template <class V>
inline auto side_by_side(V a, V b) {
  if constexpr (sizeof(V) == 8 * sizeof(a[0])) {
    return __builtin_shufflevector(
        a, b, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  } else {
    static_assert(sizeof(V) == 4 * sizeof(a[0]));
    return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
  }
}

/// a * b + c with one rounding.
template <class T, class V>
inline V multiply_add(V a, V b, V c) {
  return fma_lanes(a, b, c);
}

/// The first `count` lanes only; the others read as zero.
template <class V, class T>
inline V load_some(const T* p, Index count) {
  V v{};
  std::memcpy(&v, p, static_cast<std::size_t>(count) * sizeof(T));
  return v;
}

template <class V, class T>
inline void store_some(T* p, V v, Index count) {
  std::memcpy(p, &v, static_cast<std::size_t>(count) * sizeof(T));
}

/// The same, `count` being all of them as a rule.
template <class V, class T>
inline V load_lanes(const T* p, Index count) {
  constexpr auto all = static_cast<Index>(sizeof(V) / sizeof(T));
  return count == all ? load<V>(p) : load_some<V>(p, count);
}

template <class V, class T>
inline void store_lanes(T* p, V v, Index count) {
  constexpr auto all = static_cast<Index>(sizeof(V) / sizeof(T));
  if (count == all) {
    store(p, v);
  } else {
    store_some(p, v, count);
  }
}

/// Sum of the lanes, halves onto halves.
template <class V>
inline auto sum_of(V v) {
  using T = std::remove_cvref_t<decltype(v[0])>;
  if constexpr (sizeof(V) == 2 * sizeof(T)) {
    return v[0] + v[1];
  } else {
    Simd<T, sizeof(V) / 2> half[2];
    std::memcpy(half, &v, sizeof(v));
    return sum_of(half[0] + half[1]);
  }
}

}  // namespace physinv::nn
