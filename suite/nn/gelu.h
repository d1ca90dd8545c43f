/// GELU, x Phi(x), in its exact form: Phi is the normal distribution function.
///
/// Phi(-|x|) = e^(-x^2 / 2) s p(s),  s = 1 / (|x| / sqrt 2 + 3)
///
/// where p is smooth on the whole half line, a polynomial in 1 - 6 s within
/// 4e-9 (float) and 1e-17 (double): the Chebyshev series, cut, of
/// e^(u^2) erfc(u) (u + 3) / 2, u = |x| / sqrt 2. Beyond |x| of 13 in float, 37
/// in double, the exponential stays at its smallest normal number.
#pragma once

#include <numbers>

#include "suite/core/math.h"
#include "suite/core/simd/math.h"

namespace physinv::nn {

template <class T>
inline T normal_cdf(T x) {
  return math::erfc(-x / std::numbers::sqrt2_v<T>) / T(2);
}

template <class T>
inline T normal_density(T x) {
  constexpr T scale = std::numbers::inv_sqrtpi_v<T> / std::numbers::sqrt2_v<T>;
  return scale * math::exp(-x * x / T(2));
}

/// Phi(x); `bell` becomes e^(-x^2 / 2).
template <class P>
PHYSINV_LANES P normal_cdf_lanes(P x, P& bell) {
  using T = LaneScalar<P>;
  bell = exp_lanes((x * T(-0.5)) * x);
  constexpr T kScale = 1 / std::numbers::sqrt2_v<T>;
  const P s = 1 / fma_lanes(abs_lanes(x), kScale - P{}, 3 - P{});
  const P t = fma_lanes(s, -6 - P{}, 1 - P{});
  P p;
  if constexpr (sizeof(T) == 4) {
    static constexpr float kSeries[] = {0.5370034563F,
                                        -0.4416972259F,
                                        0.295113983F,
                                        -0.1552336789F,
                                        0.0597661884F,
                                        -0.01341305026F,
                                        -0.0006162913766F,
                                        0.001514541843F,
                                        -0.000253804891F,
                                        -0.0001333173852F,
                                        3.386683744e-5F,
                                        1.012706601e-5F};
    p = polynomial(t, kSeries);
  } else {
    static constexpr double kSeries[] = {
        0.53700345354416983932,     -0.44169722658494182503,
        0.29511417855205424288,     -0.15523363095028333436,
        0.059763880643489295191,    -0.013413617312240307486,
        -0.000606208310757389887,   0.0015170310005979912192,
        -0.00027415487262387666336, -0.0001383889241004829724,
        0.000053780891250010367119, 0.00001519909526106040124,
        -8.7358028761511653292e-6,  -2.3746955160660703949e-6,
        1.3839056127636403208e-6,   4.9971896805405066076e-7,
        -2.0587987959468796814e-7,  -1.1727335001312131505e-7,
        2.5006600921456185211e-8,   2.5834073809492270205e-8,
        -1.795680558580547638e-9,   -4.4439224457584736858e-9,
        5.5795619496251920717e-12,  4.2239263921614753975e-10};
    p = polynomial(t, kSeries);
  }
  p = p * s;
  return x > P{} ? fma_lanes(-p, bell, 1 - P{}) : p * bell;
}

template <class P>
PHYSINV_LANES P gelu_lanes(P x) {
  P bell;
  return x * normal_cdf_lanes(x, bell);
}

/// The derivative, Phi(x) + x Phi'(x).
template <class P>
PHYSINV_LANES P gelu_slope_lanes(P x) {
  using T = LaneScalar<P>;
  constexpr T scale = std::numbers::inv_sqrtpi_v<T> / std::numbers::sqrt2_v<T>;
  P bell;
  const P cdf = normal_cdf_lanes(x, bell);
  return fma_lanes(x * scale, bell, cdf);
}

}  // namespace physinv::nn
