/// Elementary functions of a register of numbers, with the bits of each alone
/// (suite/core/math.h).
#pragma once

#include "suite/core/math.h"
#include "suite/core/simd/pack.h"

namespace physinv::math {

#define PHYSINV_FUNCTIONS(T, W, kind, width)                   \
  inline Pack<T, W> exp(Pack<T, W> x) {                        \
    return Sleef_finz_exp##kind##_u10##width(x);               \
  }                                                            \
  inline Pack<T, W> log1p(Pack<T, W> x) {                      \
    return Sleef_finz_log1p##kind##_u10##width(x);             \
  }                                                            \
  inline SinCos<Pack<T, W>> sincos(Pack<T, W> x) {             \
    const auto both = Sleef_finz_sincos##kind##_u10##width(x); \
    return {both.x, both.y};                                   \
  }
#ifdef __ARM_NEON
PHYSINV_FUNCTIONS(double, 2, d2, advsimd)
PHYSINV_FUNCTIONS(float, 4, f4, advsimd)
template <class P>
requires(sizeof(P) == 32) inline P exp(P x) {
  return by_halves([](auto half) { return exp(half); }, x);
}
template <class P>
requires(sizeof(P) == 32) inline P log1p(P x) {
  return by_halves([](auto half) { return log1p(half); }, x);
}
template <class P>
requires(sizeof(P) == 32) inline SinCos<P> sincos(P x) {
  const auto low = sincos(half_of(x, 0)), high = sincos(half_of(x, 1));
  return {side_by_side(low.sine, high.sine),
          side_by_side(low.cosine, high.cosine)};
}
#else
PHYSINV_FUNCTIONS(double, 4, d4, avx2)
PHYSINV_FUNCTIONS(float, 8, f8, avx2)
#endif
#ifdef PHYSINV_AVX512
PHYSINV_FUNCTIONS(double, 8, d8, avx512f)
PHYSINV_FUNCTIONS(float, 16, f16, avx512f)
#endif
#undef PHYSINV_FUNCTIONS

}  // namespace physinv::math
