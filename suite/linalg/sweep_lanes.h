/// Several implicit QR sweeps of a symmetric tridiagonal matrix at once, one to
/// a lane: a sweep waits for a root and a division at every rotation, and may
/// follow two rows behind another one.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "suite/core/math.h"
#include "suite/linalg/eight.h"

namespace physinv::linalg {

/// Below this the sum of two squares has lost digits.
inline constexpr double kTinySquare = 1e-280;

/// Four sweeps to a register. Two such chains fill each other's waits for
/// the root and the division.
inline constexpr int kChains = 2;
inline constexpr Index kSweeps = 4 * kChains;
/// Steps from the start of the first sweep to that of the last one.
inline constexpr Index kLag = 2 * (kSweeps - 1);

/// (c, s) = (g, f) / r.
inline void rotation(double g, double f, double& c, double& s, double& r) {
  const double square = g * g + f * f;
  if (square > kTinySquare) [[likely]] {
    r = std::sqrt(square);
    const double inverse = 1 / r;
    c = g * inverse, s = f * inverse;
  } else {
    r = math::hypot(g, f);
    c = r == 0 ? 1 : g / r;
    s = r == 0 ? 0 : f / r;
  }
}

/// One sweep a lane. What it leaves in a row is what the next lane, two rows
/// behind, finds there one step later.
struct Chain {
  Four d, x, e;    ///< in: d and x of row i + 1, e_i; out: d_i, x_i, e_i-1
  Four row, head;  ///< d_i and x_i, the latter after the rotation before
  Four g, c, s, p, shift;

  /// kEdge: not all lanes are at rows `at` of [0, count) of the block. Those
  /// that are not hand their rows on by cosine 1 and sine 0.
  template <bool kEdge>
  [[gnu::always_inline]] void step(Mask<double, 4> at,
                                   Index count,
                                   double* cosine,
                                   double* sine) {
    const Four one = physinv::broadcast<Four>(1.0);
    const auto idle = (at < 0) | (at >= count);
    if constexpr (kEdge) {
      g = select(at == 0, row - shift, g);
      c = select(at == 0, one, c);
      s = select(at == 0, one, s);
    }
    const Four f = s * e, b = c * e;
    Four square = g * g + f * f;
    if constexpr (kEdge) square = select(idle, one, square);
    rotate(f, square);
    if constexpr (kEdge) {
      e = select(idle, g, e);
      c = select(idle, one, c);
      s = select(idle, Four{}, s);
    }
    g = row - p;
    const Four r = (d - g) * s + 2 * c * b, next = x;
    p = s * r;
    row = d;
    d = g + p;
    g = c * r - b;
    x = s * next + c * head;
    head = c * next - s * head;
    physinv::store(cosine, c);
    physinv::store(sine, s);
  }

  [[gnu::always_inline]] void rotate(Four f, Four square) {
    if (!any(square <= kTinySquare)) [[likely]] {
      e = sqrt_lanes(square);
      const Four inverse = 1 / e;
      c = g * inverse, s = f * inverse;
      return;
    }
    for (int lane = 0; lane < 4; ++lane) {
      double cosine, sine, root;
      rotation(g[lane], f[lane], cosine, sine, root);
      c[lane] = cosine, s[lane] = sine, e[lane] = root;
    }
  }
};

using Chains = std::array<Chain, kChains>;

/// Every lane gets what the one before it had, the first lane `next`.
[[gnu::always_inline]] inline void pass_on(Chains& chains,
                                           Four Chain::*what,
                                           double next) {
  Four before = physinv::broadcast<Four>(next);
  for (Chain& chain : chains) {
    const Four from = chain.*what;
    chain.*what = __builtin_shufflevector(from, before, 7, 0, 1, 2);
    before = from;
  }
}

/// Step t of kSweeps sweeps of the rows start ... end.
template <bool kEdge>
[[gnu::always_inline]] inline void step(Chains& chains,
                                        double* d,
                                        double* e,
                                        double* x,
                                        Index start,
                                        Index end,
                                        Index t,
                                        double* record) {
  const Index in = start + t, out = in - kLag;
  const bool more = !kEdge || in < end;
  pass_on(chains, &Chain::d, more ? d[in + 1] : 0);
  pass_on(chains, &Chain::x, more ? x[in + 1] : 0);
  pass_on(chains, &Chain::e, more ? e[in] : 0);
#pragma GCC unroll 2
  for (int k = 0; k < kChains; ++k)
    chains[k].step<kEdge>(Mask<double, 4>{0, -2, -4, -6} + (t - 8 * k),
                          end - start,
                          record + 4 * k,
                          record + 4 * k + kSweeps);
  const Chain& last = chains.back();
  if (!kEdge || out >= start) d[out] = last.d[3], x[out] = last.x[3];
  if (!kEdge || out > start) e[out - 1] = last.e[3];
}

/// x <- the rotations of kSweeps sweeps backwards; the last one leads, two rows
/// ahead. `record` is their end.
inline void turn_back_all(double* x,
                          Index start,
                          Index end,
                          const double* record) {
  Four carried[kChains]{}, rows[kChains]{};
  for (Index in = end; in >= start - kLag; --in) {
    Four after = physinv::broadcast<Four>(in >= start ? x[in] : 0);
    record -= 2 * kSweeps;
#pragma GCC unroll 2
    for (int k = kChains - 1; k >= 0; --k) {
      const Four low = __builtin_shufflevector(rows[k], after, 1, 2, 3, 4);
      const Four c = physinv::load<Four>(record + 4 * k);
      const Four s = physinv::load<Four>(record + 4 * k + kSweeps);
      after = rows[k];
      rows[k] = s * low + c * carried[k];
      carried[k] = c * low - s * carried[k];
    }
    if (in + kLag < end) x[in + kLag + 1] = rows[0][0];
  }
  x[start] = carried[0][0];
}

/// Step t of that for one part of eight vectors side by side: lanes are vectors
/// here. A row waits for the next sweep where the one before has left it.
template <bool kEdge>
[[gnu::always_inline]] inline void turn_back_step(
    double* x, Index count, Index t, Part* carried, const double* record) {
#pragma GCC unroll 8
  for (Index k = kSweeps - 1; k >= 0; --k) {
    const Index i = t - 2 * k;
    double* const row = x + i * kWidth;
    if constexpr (kEdge) {
      if (i < 0 || i >= count) continue;
      if (i == count - 1) carried[k] = physinv::load<Part>(row + kWidth);
    }
    const double c = record[k], s = record[k + kSweeps];
    const Part low = physinv::load<Part>(row);
    store(row + kWidth, s * low + c * carried[k]);
    carried[k] = c * low - s * carried[k];
    if constexpr (kEdge) {
      if (i == 0) store(row, carried[k]);
    }
  }
}

/// The steps t of [first, last] from the last one on, all sweeps inside. A row
/// that one sweep leaves is the next one's at the step after: it stays in a
/// register where there are enough of them. `record` is the end of step `last`.
inline void turn_back_inside(
    double* x, Index first, Index last, Part* carried, const double* record) {
  if constexpr (kParts > 1) {
    for (Index t = last; t >= first; --t)
      turn_back_step<false>(x, 0, t, carried, record -= 2 * kSweeps);
  } else {
    Part left[kSweeps];
#pragma GCC unroll 8
    for (Index k = 1; k < kSweeps; ++k)
      left[k] = physinv::load<Part>(x + (last - 2 * k + 2) * kWidth);
    for (Index t = last; t >= first; --t) {
      record -= 2 * kSweeps;
#pragma GCC unroll 8
      for (Index k = 0; k < kSweeps; ++k) {
        const double c = record[k], s = record[k + kSweeps];
        const Part low = k + 1 < kSweeps
                             ? left[k + 1]
                             : physinv::load<Part>(x + (t - kLag) * kWidth);
        left[k] = s * low + c * carried[k];
        carried[k] = c * low - s * carried[k];
      }
      store(x + (t + 1) * kWidth, left[0]);
    }
#pragma GCC unroll 8
    for (Index k = 1; k < kSweeps; ++k)
      store(x + (first - 2 * k + 1) * kWidth, left[k]);
  }
}

inline void turn_back_all(Pack8* x,
                          Index start,
                          Index end,
                          const double* record) {
  const Index count = end - start;
  constexpr Index kStep = 2 * kSweeps;
  for (int h = 0; h < kParts; ++h) {
    auto* const part = reinterpret_cast<double*>(x + start) + h * kPartWidth;
    Part carried[kSweeps]{};
    const double* at = record;
    Index t = count + kLag;
    for (; t >= std::max(count - 1, kLag + 1); --t)
      turn_back_step<true>(part, count, t, carried, at -= kStep);
    if (t > kLag) {
      turn_back_inside(part, kLag + 1, t, carried, at);
      at -= (t - kLag) * kStep;
      t = kLag;
    }
    for (; t >= 0; --t)
      turn_back_step<true>(part, count, t, carried, at -= kStep);
  }
}

}  // namespace physinv::linalg
