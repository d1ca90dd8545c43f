/// Columns of a batch as packs, a sample to a lane and a pack to a row
/// (structure of arrays), and back. Kernels transpose blocks of columns into
/// lanes, compute, and transpose back; no other code sees the layout. Short
/// blocks are padded.
#pragma once

#include <algorithm>
#include <cstring>
#include <utility>

#include "suite/core/batch.h"
#include "suite/core/simd/registers.h"

namespace physinv {

/// Lanes of the rows of one block: a view of `rows` packs.
///
///   Pack<T> v[2];
///   Lanes<T>(v, 2).load(x, first);   // v[r][k] = x(r, first + k)
template <class T, int W = kLanes<T>>
class Lanes {
 public:
  using P = Pack<T, W>;

  Lanes(P* packs, Index rows) : packs_(packs), rows_(rows) {}

  static constexpr Index blocks(Index columns) { return (columns + W - 1) / W; }

  /// Columns first .. first+W-1; those beyond the batch read as `pad`.
  PHYSINV_LANES void load(BatchIn<T> batch, Index first, T pad = T(0)) {
    const Index stride = batch.outerStride();
    const Index count = std::min<Index>(W, batch.cols() - first);
    const T* p = batch.data() + first * stride;
    if (rows_ == 2 && stride == 2 && count == W) {
      P pairs[2];
      std::memcpy(pairs, p, sizeof(pairs));
      return part(pairs[0], pairs[1], packs_[0], packs_[1], kAll);
    }
    if (rows_ == 4 && stride == 4 && count == W) return load_fours(p);
    for (Index r = 0; r < rows_; ++r) {
      alignas(sizeof(P)) T lane[W];
      for (Index k = 0; k < W; ++k)
        lane[k] = k < count ? p[k * stride + r] : pad;
      std::memcpy(&packs_[r], lane, sizeof(P));
    }
  }

  /// The reverse; columns beyond the batch are dropped.
  PHYSINV_LANES void store(BatchOut<T>& batch, Index first) const {
    const Index stride = batch.outerStride();
    const Index count = std::min<Index>(W, batch.cols() - first);
    T* p = batch.data() + first * stride;
    if (rows_ == 2 && stride == 2 && count == W) {
      P pairs[2];
      join(packs_[0], packs_[1], pairs[0], pairs[1], kAll);
      return static_cast<void>(std::memcpy(p, pairs, sizeof(pairs)));
    }
    if (rows_ == 4 && stride == 4 && count == W) return store_fours(p);
    for (Index r = 0; r < rows_; ++r) {
      alignas(sizeof(P)) T lane[W];
      std::memcpy(lane, &packs_[r], sizeof(P));
      for (Index k = 0; k < count; ++k) p[k * stride + r] = lane[k];
    }
  }

 private:
  static constexpr auto kAll = std::make_integer_sequence<int, W>();

  /// The numbers of even and of odd place of a, b.
  template <int... I>
  PHYSINV_LANES static void part(
      P a, P b, P& even, P& odd, std::integer_sequence<int, I...>) {
    even = __builtin_shufflevector(a, b, (2 * I)...);
    odd = __builtin_shufflevector(a, b, (2 * I + 1)...);
  }

  /// The reverse.
  template <int... I>
  PHYSINV_LANES static void join(
      P even, P odd, P& a, P& b, std::integer_sequence<int, I...>) {
    a = __builtin_shufflevector(even, odd, (I / 2 + I % 2 * W)...);
    b = __builtin_shufflevector(even, odd, (W / 2 + I / 2 + I % 2 * W)...);
  }

  /// Rows 0 and 2 alternate in `even`, 1 and 3 in `odd`.
  PHYSINV_LANES void load_fours(const T* p) {
    P in[4], even[2], odd[2];
    std::memcpy(in, p, sizeof(in));
    part(in[0], in[1], even[0], odd[0], kAll);
    part(in[2], in[3], even[1], odd[1], kAll);
    part(even[0], even[1], packs_[0], packs_[2], kAll);
    part(odd[0], odd[1], packs_[1], packs_[3], kAll);
  }

  PHYSINV_LANES void store_fours(T* p) const {
    P out[4], even[2], odd[2];
    join(packs_[0], packs_[2], even[0], even[1], kAll);
    join(packs_[1], packs_[3], odd[0], odd[1], kAll);
    join(even[0], odd[0], out[0], out[1], kAll);
    join(even[1], odd[1], out[2], out[3], kAll);
    std::memcpy(p, out, sizeof(out));
  }

  P* packs_;
  Index rows_;
};

/// In every block of four lanes: v[i][r] and v[r][i] change places.
template <class P, int... I>
PHYSINV_LANES void transpose_four(P (&v)[4], std::integer_sequence<int, I...>) {
  constexpr int W = sizeof...(I);
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

template <class P>
PHYSINV_LANES void transpose_four(P (&v)[4]) {
  constexpr int W = sizeof(P) / sizeof(LaneScalar<P>);
  transpose_four(v, std::make_integer_sequence<int, W>());
}

/// out[r * stride] = rows row + r of columns first .. of the batch; columns
/// beyond it read as zero.
template <class P>
inline void load_rows(BatchIn<LaneScalar<P>> batch,
                      Index row,
                      Index rows,
                      Index first,
                      P* out,
                      Index stride = 1) {
  using T = LaneScalar<P>;
  constexpr Index W = kLanes<T>;
  const Index step = batch.outerStride();
  const Index count = std::clamp<Index>(batch.cols() - first, 0, W);
  const T* p = batch.data() + first * step + row;
  Index r = 0;
  for (; count == W && r + 4 <= rows; r += 4) {
    P v[4];
    for (Index k = 0; k < W; ++k)
      std::memcpy(reinterpret_cast<T*>(&v[k % 4]) + k / 4 * 4,
                  p + k * step + r,
                  4 * sizeof(T));
    transpose_four(v);
    for (Index i = 0; i < 4; ++i) out[(r + i) * stride] = v[i];
  }
  for (; r < rows; ++r) {
    alignas(sizeof(P)) T lane[W] = {};
    for (Index k = 0; k < count; ++k) lane[k] = p[k * step + r];
    std::memcpy(&out[r * stride], lane, sizeof(lane));
  }
}

/// The reverse; columns beyond the batch are dropped.
template <class P>
inline void store_rows(const P* in,
                       Index stride,
                       BatchOut<LaneScalar<P>>& batch,
                       Index row,
                       Index rows,
                       Index first) {
  using T = LaneScalar<P>;
  constexpr Index W = kLanes<T>;
  const Index step = batch.outerStride();
  const Index count = std::clamp<Index>(batch.cols() - first, 0, W);
  T* p = batch.data() + first * step + row;
  Index r = 0;
  for (; count == W && r + 4 <= rows; r += 4) {
    P v[4];
    for (Index i = 0; i < 4; ++i) v[i] = in[(r + i) * stride];
    transpose_four(v);
    for (Index k = 0; k < W; ++k)
      std::memcpy(p + k * step + r,
                  reinterpret_cast<const T*>(&v[k % 4]) + k / 4 * 4,
                  4 * sizeof(T));
  }
  for (; r < rows; ++r) {
    alignas(sizeof(P)) T lane[W];
    std::memcpy(lane, &in[r * stride], sizeof(lane));
    for (Index k = 0; k < count; ++k) p[k * step + r] = lane[k];
  }
}

/// All N groups at once.
template <class P, int N>
inline void load_rows(BatchIn<LaneScalar<P>> batch,
                      Index row,
                      Index rows,
                      Index first,
                      Registers<P, N>* out) {
  for (int k = 0; k < N; ++k)
    load_rows(
        batch, row, rows, first + k * Registers<P, N>::kSize, &out->r[k], N);
}

template <class P, int N>
inline void store_rows(const Registers<P, N>* in,
                       BatchOut<LaneScalar<P>>& batch,
                       Index row,
                       Index rows,
                       Index first) {
  for (int k = 0; k < N; ++k)
    store_rows(
        &in->r[k], N, batch, row, rows, first + k * Registers<P, N>::kSize);
}

}  // namespace physinv
