/// Elementary functions of lanes: no branches, no tables, the same operations
/// in every lane. NaN stays NaN.
#pragma once

#include <cstddef>
#include <limits>
#include <numbers>
#include <type_traits>

#include "suite/core/simd/pack.h"

namespace physinv {

/// x <- c[0] + c[1] x + c[2] x^2 + ... of N packs, which go through each
/// operation together: one pack by itself would wait for the result of every
/// operation before the next.
template <class P, int N, std::size_t C>
PHYSINV_LANES void polynomials(P (&x)[N], const LaneScalar<P> (&c)[C]) {
  P sum[N];
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) sum[i] = c[C - 1] - P{};
#pragma GCC unroll 16
  for (std::size_t k = 1; k < C; ++k)
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i)
      sum[i] = fma_lanes(sum[i], x[i], c[C - 1 - k] - P{});
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) x[i] = sum[i];
}

template <class P, std::size_t C>
PHYSINV_LANES P polynomial(P x, const LaneScalar<P> (&c)[C]) {
  P one[] = {x};
  polynomials(one, c);
  return one[0];
}

/// Added to a number of at most 2^(digits-3), leaves its nearest integer in
/// the last bits of the mantissa.
template <class T>
inline constexpr T kRounder =
    static_cast<T>(std::int64_t{3} << (std::numeric_limits<T>::digits - 2));

/// Nearest integer, ties to even.
template <class P>
PHYSINV_LANES P round_lanes(P x) {
  constexpr auto kMagic = kRounder<LaneScalar<P>>;
  return (x + kMagic) - kMagic;
}

/// 1, -1, or x itself where that is a zero or NaN.
template <class P>
PHYSINV_LANES P sign_lanes(P x) {
  const P one = 1 - P{};
  return x > P{} ? one : x < P{} ? -one : x;
}

/// sin(2 pi r) for |r| <= 1/2. Absolute error 1e-6 in float, 2e-15 in double.
/// The series of sin(pi z) in Chebyshev polynomials over a whole period, cut
/// where its terms vanish.
template <class P>
PHYSINV_LANES P sin_of_turn(P r) {
  if constexpr (sizeof(LaneScalar<P>) == 4) {
    constexpr float kSeries[] = {6.2831827934070340683F,
                                 -41.34141938561704525F,
                                 81.596138755381066118F,
                                 -76.579687851009453106F,
                                 41.203743633626471892F,
                                 -12.268859940959197471F};
    return r * polynomial(r * r, kSeries);
  } else {
    constexpr double kSeries[] = {6.2831853071795863724,
                                  -41.341702240399723407,
                                  81.605249276071220396,
                                  -76.705859752877140976,
                                  42.058693939977039016,
                                  -15.094642496505986869,
                                  3.8199517424304101838,
                                  -0.71811650420801941271,
                                  0.10420310219871860241,
                                  -0.011957768650469480496,
                                  0.0010106614446953475128};
    return r * polynomial(r * r, kSeries);
  }
}

/// sin(2 pi t) as good as that where t itself is exact; |t| < 2^(digits-3).
template <class P>
PHYSINV_LANES P sin_turns(P t) {
  return sin_of_turn(t - round_lanes(t));
}

/// e^x of N packs, relative error about 2 eps. Beyond the range of normal
/// numbers the value at its end.
template <class P, int N>
PHYSINV_LANES void exp_lanes(P (&x)[N]) {
  using T = LaneScalar<P>;
  using I = Mask<T, sizeof(P) / sizeof(T)>;
  constexpr bool kSingle = sizeof(T) == 4;
  constexpr T kEnd = kSingle ? T(87) : T(708);
  constexpr int kMantissa = std::numeric_limits<T>::digits - 1;
  constexpr LaneInt<T> kBias = std::numeric_limits<T>::max_exponent - 1;
  // ln 2 in two parts, the first with so few digits that n * high is exact.
  constexpr T kHigh = kSingle ? T(0x1.62e4p-1) : T(0x1.62e42fefap-1);
  constexpr T kLow =
      kSingle ? T(0x1.7f7d1cf79abcap-20) : T(0x1.cf79abc9e3b39p-40);
  P scale[N];
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) {
    const P in = x[i] > kEnd ? kEnd - P{} : x[i] < -kEnd ? -kEnd - P{} : x[i];
    const P shifted =
        fma_lanes(std::numbers::log2e_v<T>, in, kRounder<T> - P{});
    const P n = shifted - kRounder<T>;
    x[i] = fma_lanes(-kLow, n, fma_lanes(-kHigh, n, in));
    scale[i] = (P)(((I)shifted << kMantissa) + (kBias << kMantissa));
  }
  if constexpr (kSingle) {
    static constexpr float kTaylor[] = {
        1, 1, 1.F / 2, 1.F / 6, 1.F / 24, 1.F / 120, 1.F / 720, 1.F / 5040};
    polynomials(x, kTaylor);
  } else {
    static constexpr double kTaylor[] = {1,
                                         1,
                                         1. / 2,
                                         1. / 6,
                                         1. / 24,
                                         1. / 120,
                                         1. / 720,
                                         1. / 5040,
                                         1. / 40320,
                                         1. / 362880,
                                         1. / 3628800,
                                         1. / 39916800,
                                         1. / 479001600,
                                         1. / 6227020800};
    polynomials(x, kTaylor);
  }
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) x[i] = x[i] * scale[i];
}

template <class P>
PHYSINV_LANES P exp_lanes(P x) {
  P one[] = {x};
  exp_lanes(one);
  return one[0];
}

/// tanh x of N packs, absolute error about eps.
template <class P, int N>
PHYSINV_LANES void tanh_lanes(P (&x)[N]) {
  using T = LaneScalar<P>;
  using I = Mask<T, sizeof(P) / sizeof(T)>;
  P e[N];
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) e[i] = abs_lanes(x[i]) + abs_lanes(x[i]);
  exp_lanes(e);
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) {
    const P less = e[i] - 1, y = less / (less + 2);
    x[i] = (P)((I)y | ((I)x[i] & std::numeric_limits<LaneInt<T>>::min()));
  }
}

template <class P>
PHYSINV_LANES P tanh_lanes(P x) {
  P one[] = {x};
  tanh_lanes(one);
  return one[0];
}

/// 1 / (1 + e^-x) of N packs, relative error about 3 eps, for x from -87 in
/// float, -708 in double; below, the value there.
template <class P, int N>
PHYSINV_LANES void sigmoid_lanes(P (&x)[N]) {
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) x[i] = -x[i];
  exp_lanes(x);
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) x[i] = 1 / (1 + x[i]);
}

template <class P>
PHYSINV_LANES P sigmoid_lanes(P x) {
  P one[] = {x};
  sigmoid_lanes(one);
  return one[0];
}

}  // namespace physinv
