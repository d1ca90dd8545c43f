/// Several registers of lanes as one value. Chains of dependent operations run
/// at the latency of one operation per register; N independent registers hide
/// each other's latency. They stand for N groups of samples, or for N
/// right-hand sides of the same samples.
#pragma once

#include <algorithm>
#include <cstring>

#include "suite/core/lanes.h"

namespace physinv {

template <class T, int N>
struct Wide {
  using P = Pack<T>;
  static constexpr Index kSamples = N * kLanes<T>;

  P r[N];

  template <class F>
  PHYSINV_LANES static Wide make(F&& f) {
    Wide w;
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) w.r[k] = f(k);
    return w;
  }

  PHYSINV_LANES friend Wide operator+(const Wide& a, const Wide& b) {
    return make([&](int k) { return a.r[k] + b.r[k]; });
  }
  PHYSINV_LANES friend Wide operator-(const Wide& a, const Wide& b) {
    return make([&](int k) { return a.r[k] - b.r[k]; });
  }
  PHYSINV_LANES friend Wide operator*(const Wide& a, const Wide& b) {
    return make([&](int k) { return a.r[k] * b.r[k]; });
  }
  /// One factor for all registers.
  PHYSINV_LANES friend Wide operator*(P a, const Wide& b) {
    return make([&](int k) { return a * b.r[k]; });
  }
  PHYSINV_LANES friend Wide operator*(T a, const Wide& b) {
    return make([&](int k) { return a * b.r[k]; });
  }
  PHYSINV_LANES friend Wide operator-(const Wide& a) {
    return make([&](int k) { return -a.r[k]; });
  }
  /// a b + c, rounded once.
  PHYSINV_LANES friend Wide fma_lanes(const Wide& a,
                                      const Wide& b,
                                      const Wide& c) {
    return make([&](int k) { return fma_lanes(a.r[k], b.r[k], c.r[k]); });
  }
  PHYSINV_LANES friend Wide fma_lanes(P a, const Wide& b, const Wide& c) {
    return make([&](int k) { return fma_lanes(a, b.r[k], c.r[k]); });
  }
  PHYSINV_LANES friend Wide fma_lanes(T a, const Wide& b, const Wide& c) {
    return make([&](int k) { return fma_lanes(a, b.r[k], c.r[k]); });
  }
};

namespace detail {

/// In every block of four lanes: v[i][r] and v[r][i] change places.
template <class T, int... I>
PHYSINV_LANES void transpose_four(Pack<T> (&v)[4],
                                  std::integer_sequence<int, I...>) {
  constexpr int W = kLanes<T>;
  using P = Pack<T>;
  const P low01 = __builtin_shufflevector(
      v[0], v[1], (I / 4 * 4 + I % 4 / 2 + I % 2 * W)...);
  const P high01 = __builtin_shufflevector(
      v[0], v[1], (I / 4 * 4 + 2 + I % 4 / 2 + I % 2 * W)...);
  const P low23 = __builtin_shufflevector(
      v[2], v[3], (I / 4 * 4 + I % 4 / 2 + I % 2 * W)...);
  const P high23 = __builtin_shufflevector(
      v[2], v[3], (I / 4 * 4 + 2 + I % 4 / 2 + I % 2 * W)...);
  v[0] = __builtin_shufflevector(
      low01, low23, (I / 4 * 4 + I % 2 + I % 4 / 2 * W)...);
  v[1] = __builtin_shufflevector(
      low01, low23, (I / 4 * 4 + 2 + I % 2 + I % 4 / 2 * W)...);
  v[2] = __builtin_shufflevector(
      high01, high23, (I / 4 * 4 + I % 2 + I % 4 / 2 * W)...);
  v[3] = __builtin_shufflevector(
      high01, high23, (I / 4 * 4 + 2 + I % 2 + I % 4 / 2 * W)...);
}

template <class T>
PHYSINV_LANES void transpose_four(Pack<T> (&v)[4]) {
  transpose_four<T>(v, std::make_integer_sequence<int, kLanes<T>>());
}

}  // namespace detail

/// out[r * stride] = rows row + r of columns first .. of the batch; columns
/// beyond it read as zero.
template <class T>
inline void load_rows(BatchIn<T> batch,
                      Index row,
                      Index rows,
                      Index first,
                      Pack<T>* out,
                      Index stride = 1) {
  constexpr Index W = kLanes<T>;
  const Index step = batch.outerStride();
  const Index count = std::clamp<Index>(batch.cols() - first, 0, W);
  const T* p = batch.data() + first * step + row;
  Index r = 0;
  for (; count == W && r + 4 <= rows; r += 4) {
    Pack<T> v[4];
    for (Index k = 0; k < W; ++k)
      std::memcpy(reinterpret_cast<T*>(&v[k % 4]) + k / 4 * 4,
                  p + k * step + r,
                  4 * sizeof(T));
    detail::transpose_four<T>(v);
    for (Index i = 0; i < 4; ++i) out[(r + i) * stride] = v[i];
  }
  for (; r < rows; ++r) {
    alignas(sizeof(Pack<T>)) T lane[W] = {};
    for (Index k = 0; k < count; ++k) lane[k] = p[k * step + r];
    std::memcpy(&out[r * stride], lane, sizeof(lane));
  }
}

/// The reverse; columns beyond the batch are dropped.
template <class T>
inline void store_rows(const Pack<T>* in,
                       Index stride,
                       BatchOut<T>& batch,
                       Index row,
                       Index rows,
                       Index first) {
  constexpr Index W = kLanes<T>;
  const Index step = batch.outerStride();
  const Index count = std::clamp<Index>(batch.cols() - first, 0, W);
  T* p = batch.data() + first * step + row;
  Index r = 0;
  for (; count == W && r + 4 <= rows; r += 4) {
    Pack<T> v[4];
    for (Index i = 0; i < 4; ++i) v[i] = in[(r + i) * stride];
    detail::transpose_four<T>(v);
    for (Index k = 0; k < W; ++k)
      std::memcpy(p + k * step + r,
                  reinterpret_cast<const T*>(&v[k % 4]) + k / 4 * 4,
                  4 * sizeof(T));
  }
  for (; r < rows; ++r) {
    alignas(sizeof(Pack<T>)) T lane[W];
    std::memcpy(lane, &in[r * stride], sizeof(lane));
    for (Index k = 0; k < count; ++k) p[k * step + r] = lane[k];
  }
}

/// All N groups at once.
template <class T, int N>
inline void load_rows(
    BatchIn<T> batch, Index row, Index rows, Index first, Wide<T, N>* out) {
  for (int k = 0; k < N; ++k)
    load_rows<T>(batch, row, rows, first + k * kLanes<T>, &out->r[k], N);
}

template <class T, int N>
inline void store_rows(const Wide<T, N>* in,
                       BatchOut<T>& batch,
                       Index row,
                       Index rows,
                       Index first) {
  for (int k = 0; k < N; ++k)
    store_rows<T>(&in->r[k], N, batch, row, rows, first + k * kLanes<T>);
}

}  // namespace physinv
