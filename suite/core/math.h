/// Elementary functions with the same bits on every processor. The C library
/// has several versions of exp, sin, log and pow, chooses among them by the
/// processor and changes them from release to release; its hypot takes other
/// formulas on x86-64 and aarch64. Here they are SLEEF's deterministic ones
/// (https://sleef.org, "finz": fused operations, same bits for every length of
/// vector). Errors below 1 ulp, erfc below 1.5 ulp; NaN and infinities as in
/// the C standard; errno stays as it is.
///
/// Every number that is recorded or printed comes from these. What IEEE 754
/// rounds exactly (sqrt, fma, floor, remainder, ...) is taken from the standard
/// library.
#pragma once

#include <sleef.h>

#include <cmath>
#include <complex>
#include <limits>
#include <utility>

namespace physinv::math {

#define PHYSINV_FUNCTION(name, accuracy)                  \
  inline double name(double x) {                          \
    return Sleef_finz_##name##d1_##accuracy##purecfma(x); \
  }                                                       \
  inline float name(float x) {                            \
    return Sleef_finz_##name##f1_##accuracy##purecfma(x); \
  }
PHYSINV_FUNCTION(exp, u10)
PHYSINV_FUNCTION(exp2, u10)
PHYSINV_FUNCTION(expm1, u10)
PHYSINV_FUNCTION(log, u10)
PHYSINV_FUNCTION(log1p, u10)
PHYSINV_FUNCTION(log2, u10)
PHYSINV_FUNCTION(log10, u10)
PHYSINV_FUNCTION(sin, u10)
PHYSINV_FUNCTION(cos, u10)
PHYSINV_FUNCTION(tan, u10)
PHYSINV_FUNCTION(asin, u10)
PHYSINV_FUNCTION(acos, u10)
PHYSINV_FUNCTION(tanh, u10)
PHYSINV_FUNCTION(atanh, u10)
PHYSINV_FUNCTION(erf, u10)
PHYSINV_FUNCTION(erfc, u15)
PHYSINV_FUNCTION(lgamma, u10)
#undef PHYSINV_FUNCTION

/// The angle of (x, y), from -pi to pi.
inline double atan2(double y, double x) {
  return Sleef_finz_atan2d1_u10purecfma(y, x);
}

/// x^y
inline double pow(double x, double y) {
  return Sleef_finz_powd1_u10purecfma(x, y);
}
inline float pow(float x, float y) {
  return Sleef_finz_powf1_u10purecfma(x, y);
}

/// sqrt(x^2 + y^2) of numbers whose squares are normal, x >= y > 0: the root
/// of the rounded sum, less the rest of h^2 - x^2 - y^2 over 2 h, which is
/// written so that no product cancels. Source: C. F. Borges, Algorithm 1014: An
/// Improved Algorithm for hypot(x, y), ACM Trans. Math. Softw. 47 (2020).
inline double corrected_hypot(double x, double y) {
  const double h = std::sqrt(x * x + y * y);
  double rest;
  if (h <= 2 * y) {
    const double d = h - y;
    rest = x * (2 * d - x) + (d - 2 * (x - y)) * d;
  } else {
    const double d = h - x;
    rest = 2 * d * (x - 2 * y) + ((4 * d - y) * y + d * d);
  }
  return h - rest / (2 * h);
}

/// sqrt(x^2 + y^2) without overflow or underflow on the way, error below 1 ulp;
/// infinity if one of them is infinite, even if the other is NaN.
inline double hypot(double x, double y) {
  if (!std::isfinite(x) || !std::isfinite(y)) {
    if (std::isinf(x) || std::isinf(y))
      return std::numeric_limits<double>::infinity();
    return x + y;
  }
  double a = std::abs(x), b = std::abs(y);
  if (a < b) std::swap(a, b);
  if (b * 0x1p54 <= a) return a + b;
  constexpr double kLarge = 0x1p511, kTiny = 0x1p-459, kScale = 0x1p600;
  if (a > kLarge) return corrected_hypot(a / kScale, b / kScale) * kScale;
  if (b < kTiny) return corrected_hypot(a * kScale, b * kScale) / kScale;
  return corrected_hypot(a, b);
}
/// Squares of floats are exact in double.
inline float hypot(float x, float y) {
  if (std::isinf(x) || std::isinf(y))
    return std::numeric_limits<float>::infinity();
  const double a = x, b = y;
  return static_cast<float>(std::sqrt(a * a + b * b));
}

/// |z|
template <class T>
T abs(const std::complex<T>& z) {
  return hypot(z.real(), z.imag());
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

}  // namespace physinv::math
