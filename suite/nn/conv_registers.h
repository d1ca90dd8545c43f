/// Registers of the products of a convolution.
#pragma once

#include <cstring>

#include "suite/core/simd/pack.h"

namespace physinv::nn {

/// Two narrow vectors share a wide register: what is computed of each stays as
/// it is, in half the instructions.
template <class T, class V, bool kPair>
struct Register {
  static constexpr int kVectors = kPair ? 2 : 1;
  using P = Pack<T, kVectors* static_cast<int>(sizeof(V) / sizeof(T))>;

  /// a, and b if there is room for it.
  static P of(const T* a, const T* b) {
    if constexpr (kPair) {
      return side_by_side(load<V>(a), load<V>(b));
    } else {
      return load<V>(a);
    }
  }
  /// a in both halves, by one load and no shuffle.
  static P twice(const T* a) {
#ifdef PHYSINV_AVX512
    if constexpr (kPair && sizeof(T) == 4) {
      return reinterpret_cast<P>(
          _mm512_maskz_broadcast_f32x8(0xFFFF, _mm256_loadu_ps(a)));
    } else if constexpr (kPair) {
      return reinterpret_cast<P>(
          _mm512_maskz_broadcast_f64x4(0xFF, _mm256_loadu_pd(a)));
    }
#endif
    return of(a, a);
  }
  static void put(P v, T* a, T* b) {
    if constexpr (kPair) {
      V halves[2];
      std::memcpy(halves, &v, sizeof(v));
      store(a, halves[0]), store(b, halves[1]);
    } else {
      store(a, v);
    }
  }
};
template <class T, class V>
constexpr bool kPairs = 2 * sizeof(V) <= kVectorBytes;

}  // namespace physinv::nn
