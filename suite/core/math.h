/// Elementary functions with the same bits on every processor. The C library
/// has several versions of exp, sin, log and pow, chooses among them by the
/// processor and changes them from release to release; here they are SLEEF's
/// deterministic ones (https://sleef.org, "finz": fused operations, same bits
/// for every length of vector). Errors below 1 ulp, erfc below 1.5 ulp; NaN and
/// infinities as in the C standard; errno stays as it is.
///
/// What computes numbers takes these. What IEEE 754 rounds exactly (sqrt, fma,
/// floor, remainder, ...) is taken from the standard library.
#pragma once

#include "suite/core/simd/pack.h"

// Eigen is not to see AVX-512 (cmake/physinv.cmake), SLEEF is.
#pragma push_macro("__AVX512F__")
#undef __AVX512F__
#ifdef PHYSINV_AVX512
#define __AVX512F__ 1
#endif
#include <sleef.h>
#pragma pop_macro("__AVX512F__")

namespace physinv::math {

#define PHYSINV_FUNCTION(name, accuracy)                  \
  inline double name(double x) {                          \
    return Sleef_finz_##name##d1_##accuracy##purecfma(x); \
  }                                                       \
  inline float name(float x) {                            \
    return Sleef_finz_##name##f1_##accuracy##purecfma(x); \
  }
PHYSINV_FUNCTION(exp, u10)
PHYSINV_FUNCTION(expm1, u10)
PHYSINV_FUNCTION(log, u10)
PHYSINV_FUNCTION(log1p, u10)
PHYSINV_FUNCTION(log2, u10)
PHYSINV_FUNCTION(log10, u10)
PHYSINV_FUNCTION(sin, u10)
PHYSINV_FUNCTION(cos, u10)
PHYSINV_FUNCTION(tan, u10)
PHYSINV_FUNCTION(asin, u10)
PHYSINV_FUNCTION(tanh, u10)
PHYSINV_FUNCTION(erf, u10)
PHYSINV_FUNCTION(erfc, u15)
PHYSINV_FUNCTION(lgamma, u10)
#undef PHYSINV_FUNCTION

/// x^y
inline double pow(double x, double y) {
  return Sleef_finz_powd1_u10purecfma(x, y);
}
inline float pow(float x, float y) {
  return Sleef_finz_powf1_u10purecfma(x, y);
}

template <class T>
struct SinCos {
  T sine, cosine;
};

/// In the time of one, but not with the bits of `sin` and `cos`.
inline SinCos<double> sincos(double x) {
  const auto both = Sleef_finz_sincosd1_u10purecfma(x);
  return {both.x, both.y};
}
inline SinCos<float> sincos(float x) {
  const auto both = Sleef_finz_sincosf1_u10purecfma(x);
  return {both.x, both.y};
}

/// Of a register of numbers, with the bits of each alone.
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
PHYSINV_FUNCTIONS(double, 4, d4, avx2)
PHYSINV_FUNCTIONS(float, 8, f8, avx2)
#ifdef PHYSINV_AVX512
PHYSINV_FUNCTIONS(double, 8, d8, avx512f)
PHYSINV_FUNCTIONS(float, 16, f16, avx512f)
#endif
#undef PHYSINV_FUNCTIONS

}  // namespace physinv::math
