/// The time step of the quantum dipole, in lanes: factorisation and solve.
#pragma once

#include "problems/quantum_dipole/quantum_dipole.h"
#include "suite/core/simd/samples.h"

namespace physinv::quantum {

inline constexpr int kPoints = kQuantumPoints;
/// Where elimination from the left wall and from the right meet.
inline constexpr int kMiddle = kPoints / 2;
inline constexpr Index kChunk = 4;  ///< steps that are factored together

template <class T>
struct Constants {
  explicit Constants(const QuantumDipoleOptions& o) : steps(o.steps) {
    const double dx = 2.0 / (kPoints + 1), r = o.dt / (2 * dx * dx);
    inverse_r = T(1 / r);
    twice_inverse_r = T(2 / r);
    for (int j = 0; j < kPoints; ++j) {
      slope[j] = T(o.dt / 2 * (j + 1) * dx / r);
      pull[j] = T(o.dt / 4 * (j + 1) * dx);
    }
  }
  Index steps;
  T inverse_r, twice_inverse_r;
  T slope[kPoints];  ///< dt/2 x_j / r
  T pull[kPoints];   ///< dt/4 x_j
};

template <class V>
struct Complex {
  V re, im;
};

/// a b + c
template <class E, class V>
PHYSINV_LANES Complex<V> multiply_add(const Complex<E>& a,
                                      const Complex<V>& b,
                                      const Complex<V>& c) {
  return {fma_lanes(-a.im, b.im, fma_lanes(a.re, b.re, c.re)),
          fma_lanes(a.im, b.re, fma_lanes(a.re, b.im, c.im))};
}

/// a b. Imaginary parts of e are the larger ones for small steps: theirs are
/// the products that are not rounded.
template <class E, class V>
PHYSINV_LANES Complex<V> multiply(const Complex<E>& a, const Complex<V>& b) {
  return {fma_lanes(-a.im, b.im, a.re * b.re),
          fma_lanes(a.im, b.re, a.re * b.im)};
}

/// e_j = i r p_j of `count` lanes of (step, sample): e[k * kPoints + j] for
/// control u[k]. 1 / e_j = 2 + slope_j u - i / r - e_{j -+ 1}.
template <class T>
void factor(const Constants<T>& k,
            const Pack<T>* u,
            int count,
            Complex<Pack<T>>* e) {
  using P = Pack<T>;
  const P zero{}, two = P{} + T(2);
  const T inverse_r = k.inverse_r;
  // One division for the two chains: 1 / a = b / (a b).
  for (int j = 0; j + 1 < kMiddle; ++j) {
    const int l = kPoints - 1 - j;
    const T left = k.slope[j], right = k.slope[l];
    for (int n = 0; n < count; ++n) {
      Complex<P>* at = e + n * kPoints;
      const Complex<P> before = j > 0 ? at[j - 1] : Complex<P>{zero, zero};
      const Complex<P> after = j > 0 ? at[l + 1] : Complex<P>{zero, zero};
      const P ar = fma_lanes(left, u[n], two) - before.re;
      const P ai = inverse_r + before.im;
      const P br = fma_lanes(right, u[n], two) - after.re;
      const P bi = inverse_r + after.im;
      const P a2 = fma_lanes(ai, ai, ar * ar), b2 = fma_lanes(bi, bi, br * br);
      const P shared = T(1) / (a2 * b2);
      const P a = b2 * shared, b = a2 * shared;
      at[j] = {ar * a, ai * a};
      at[l] = {br * b, bi * b};
    }
  }
  for (int j = kMiddle - 1; j <= kMiddle; ++j) {
    const T slope = k.slope[j];
    for (int n = 0; n < count; ++n) {
      Complex<P>* at = e + n * kPoints;
      P re = fma_lanes(slope, u[n], two) - at[j - 1].re;
      P im = inverse_r + at[j - 1].im;
      if (j == kMiddle) re = re - at[j + 1].re, im = im + at[j + 1].im;
      const P scale = T(1) / fma_lanes(im, im, re * re);
      at[j] = {re * scale, im * scale};
    }
  }
}

/// Solves M y = 2 c, calls sink(j, y_j), and sets c <- y - c. `e(j)` gives the
/// factorisation; V may hold several right-hand sides that share it.
template <class T, class V, class E, class Sink>
PHYSINV_LANES void advance(const Constants<T>& k,
                           const E& e,
                           Complex<V>* c,
                           Sink&& sink) {
  const T s = k.twice_inverse_r;
  // sum - i s v
  const auto right_side = [s](const Complex<V>& sum, const Complex<V>& v)
      __attribute__((always_inline)) {
    return Complex<V>{fma_lanes(s, v.im, sum.re), fma_lanes(-s, v.re, sum.im)};
  };
  Complex<V> y[kPoints];
  y[0] = multiply(e(0), Complex<V>{s * c[0].im, -(s * c[0].re)});
  y[kPoints - 1] =
      multiply(e(kPoints - 1),
               Complex<V>{s * c[kPoints - 1].im, -(s * c[kPoints - 1].re)});
#pragma GCC unroll 8
  for (int j = 1; j < kMiddle; ++j) {
    const int l = kPoints - 1 - j;
    y[j] = multiply(e(j), right_side(y[j - 1], c[j]));
    if (l == kMiddle) continue;
    y[l] = multiply(e(l), right_side(y[l + 1], c[l]));
  }
  constexpr int m = kMiddle;
  y[m] = multiply(
      e(m),
      right_side({y[m - 1].re + y[m + 1].re, y[m - 1].im + y[m + 1].im}, c[m]));
  const auto leave = [&](int j) __attribute__((always_inline)) {
    sink(j, y[j]);
    c[j] = {y[j].re - c[j].re, y[j].im - c[j].im};
  };
  leave(m);
#pragma GCC unroll 8
  for (int j = m - 1; j >= 0; --j) {
    const int l = kPoints - 1 - j;
    y[j] = multiply_add(e(j), y[j + 1], y[j]);
    leave(j);
    if (l == m) continue;
    y[l] = multiply_add(e(l), y[l - 1], y[l]);
    leave(l);
  }
}

}  // namespace physinv::quantum
