/// The products of layers of a handful of neurons, row by row. Calls of tiles
/// would cost more than their arithmetic.
#pragma once

#include <algorithm>
#include <utility>

#include "suite/core/simd/pack.h"
#include "suite/nn/activation.h"
#include "suite/nn/gemm.h"

namespace physinv::nn {

/// Numbers of A, or of a weight gradient, up to which this is faster.
inline constexpr Index kThin = 16;
/// Rows whose sums are formed together.
inline constexpr Index kRowGroup = 4;

template <class T>
bool is_thin(const Gemm<T>& g) {
  return g.m * g.k <= kThin;
}

/// Four vectors of row i from column j on; f(lanes, row, columns) finishes
/// them. In the last group of a row those that are missing repeat its last one.
template <bool kWhole, class T, class F>
[[gnu::always_inline]] inline void thin_group(
    const Gemm<T>& g, Index i, Index j, Index last, F&& f) {
  using V = NarrowPack<T>;
  constexpr Index w = kNarrowLanes<T>;
  const auto at = [=](Index q) { return (kWhole ? q : std::min(q, last)) * w; };
  V v[4];
#pragma GCC unroll 4
  for (Index q = 0; q < 4; ++q)
    v[q] = broadcast<V>(g.bias != nullptr ? g.bias[i] : T(0));
  const T* a = g.a + i * g.a_row;
  const T* b = g.b + j;
  for (Index k = 0; k < g.k; ++k, a += g.a_k, b += g.b_stride) {
    const V s = broadcast<V>(*a);
#pragma GCC unroll 4
    for (Index q = 0; q < 4; ++q) v[q] = fma_lanes(s, load<V>(b + at(q)), v[q]);
  }
  f(v, i, j);
  T* const to = g.c + i * g.c_stride + j;
#pragma GCC unroll 4
  for (Index q = 0; q < 4; ++q) {
    if (kWhole) {
      store(to + q * w, v[q]);
    } else if (q <= last) {
      store_lanes(to + q * w, v[q], std::min(w, g.n - j - q * w));
    }
  }
}

template <class T, class F>
[[gnu::noinline]] void thin_rows(const Gemm<T>& g, F f) {
  constexpr Index w = kNarrowLanes<T>, four = 4 * w;
  for (Index i = 0; i < g.m; ++i) {
    Index j = 0;
    for (; j + four <= g.n; j += four) thin_group<true>(g, i, j, 3, f);
    if (j < g.n) thin_group<false>(g, i, j, (g.n - j - 1) / w, f);
  }
}

/// As gemm, with its bits.
template <class T>
void thin_product(const Gemm<T>& g) {
  using V = NarrowPack<T>;
  const bool free = g.activation == Activation::identity;
  const auto gate = [&](Activation kind, V(&v)[4], Index i, Index j) {
    const T* const y = g.gate + i * g.gate_stride + j;
#pragma GCC unroll 4
    for (Index q = 0; q < 4; ++q) {
      const Index some =
          std::min(kNarrowLanes<T>, g.n - j - q * kNarrowLanes<T>);
      if (some > 0)
        v[q] = pull_lanes<T>(
            kind, load_lanes<V>(y + q * kNarrowLanes<T>, some), v[q]);
    }
  };
  if (g.gate == nullptr && free)
    return thin_rows(g, [](V(&)[4], Index, Index) {});
  if (g.gate == nullptr && g.activation == Activation::tanh)
    return thin_rows(g, [](V(&v)[4], Index, Index) { tanh_lanes(v); });
  if (free && g.gate_activation == Activation::tanh)
    return thin_rows(g, [&](V(&v)[4], Index i, Index j) {
      gate(Activation::tanh, v, i, j);
    });
  thin_rows(g, [&](V(&v)[4], Index i, Index j) {
    for (V& x : v) x = activate_lanes<T>(g.activation, x);
    if (g.gate != nullptr) gate(g.gate_activation, v, i, j);
  });
}

/// Whether row_products is faster than a transpose and gemm: for few rows of x
/// and y, enough of one of them to fill a group.
inline bool are_thin(Index x_rows, Index y_rows) {
  return x_rows * y_rows <= kThin && std::max(x_rows, y_rows) >= kRowGroup;
}

/// out[i * x_step + j * y_step] = x_i . y_j over the samples. One of the two
/// has zeros behind the last sample. The fewer rows are taken one by one, the
/// others in groups.
template <class T>
void row_products(
    Rows<const T> x, Rows<const T> y, T* out, Index x_step, Index y_step) {
  using V = NarrowPack<T>;
  constexpr Index w = kNarrowLanes<T>;
  if (y.rows < x.rows) std::swap(x, y), std::swap(x_step, y_step);
  for (Index i = 0; i < x.rows; ++i)
    for (Index j = 0; j < y.rows; j += kRowGroup) {
      const Index last = std::min(kRowGroup, y.rows - j) - 1;
      const T* rows[kRowGroup];
      V even[kRowGroup] = {}, odd[kRowGroup] = {};
#pragma GCC unroll 4
      for (Index q = 0; q < kRowGroup; ++q)
        rows[q] = y.row(j + std::min(q, last));
      Index c = 0;
      for (; c + 2 * w <= x.width; c += 2 * w) {
        const V first = held(load<V>(x.row(i) + c));
        const V second = held(load<V>(x.row(i) + c + w));
#pragma GCC unroll 4
        for (Index q = 0; q < kRowGroup; ++q) {
          even[q] = fma_lanes(first, load<V>(rows[q] + c), even[q]);
          odd[q] = fma_lanes(second, load<V>(rows[q] + c + w), odd[q]);
        }
      }
      for (Index q = 0; q <= last; ++q) {
        V sum = even[q] + odd[q];
        if (c < x.width)
          sum = fma_lanes(load<V>(x.row(i) + c), load<V>(rows[q] + c), sum);
        out[i * x_step + (j + q) * y_step] = sum_of(sum);
      }
    }
}

}  // namespace physinv::nn
