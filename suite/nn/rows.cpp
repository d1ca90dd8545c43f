#include "suite/nn/rows.h"

#include <algorithm>

#include "suite/core/check.h"
#include "suite/core/simd/pack.h"

namespace physinv::nn {
namespace {

using F = NarrowPack<float>;
using D = NarrowPack<double>;

/// One vector per row: rows and columns change places.
[[gnu::always_inline]] inline void turn(D (&v)[4]) {
  const D a = __builtin_shufflevector(v[0], v[1], 0, 4, 2, 6);
  const D b = __builtin_shufflevector(v[0], v[1], 1, 5, 3, 7);
  const D c = __builtin_shufflevector(v[2], v[3], 0, 4, 2, 6);
  const D d = __builtin_shufflevector(v[2], v[3], 1, 5, 3, 7);
  v[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  v[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  v[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  v[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

/// The same by pairs, by fours, by halves.
[[gnu::always_inline]] inline void turn(F (&v)[8]) {
  F pairs[8], fours[8];
#pragma GCC unroll 4
  for (int i = 0; i < 8; i += 2) {
    const F a = v[i], b = v[i + 1];
    pairs[i] = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
    pairs[i + 1] = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  }
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    const F a = pairs[i / 2 * 4 + i % 2], b = pairs[i / 2 * 4 + i % 2 + 2];
    fours[2 * i] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
    fours[2 * i + 1] =
        __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
  }
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    const F a = fours[i], b = fours[i + 4];
    v[i] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
    v[i + 4] = __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

/// The first `rows` of a square; the others read as zero.
template <bool kWhole, class T>
void transpose_square(
    const T* from, Index from_stride, T* to, Index to_stride, Index rows) {
  using V = NarrowPack<T>;
  constexpr int w = static_cast<int>(kNarrowLanes<T>);
  V v[w];
#pragma GCC unroll 8
  for (int i = 0; i < w; ++i)
    v[i] = kWhole || i < rows ? load<V>(from + i * from_stride) : V{};
  turn(v);
#pragma GCC unroll 8
  for (int i = 0; i < w; ++i) store(to + i * to_stride, v[i]);
}

/// Rows i to i + w of a transpose as far as they fill squares.
template <bool kWhole, class T>
void transpose_squares(const T* from,
                       Index from_stride,
                       Index cols,
                       T* to,
                       Index to_stride,
                       Index rows) {
  for (Index j = 0; j + kNarrowLanes<T> <= cols; j += kNarrowLanes<T>)
    transpose_square<kWhole>(
        from + j, from_stride, to + j * to_stride, to_stride, rows);
}

}  // namespace

template <class T>
void transpose(const T* from,
               Index from_stride,
               Index rows,
               Index cols,
               T* to,
               Index to_stride,
               Behind behind) {
  constexpr Index w = kNarrowLanes<T>;
  const bool zeros = behind == Behind::zeros;
  Index i = 0;
  for (; i + w <= rows; i += w)
    transpose_squares<true>(
        from + i * from_stride, from_stride, cols, to + i, to_stride, w);
  if (zeros && i < rows)
    transpose_squares<false>(
        from + i * from_stride, from_stride, cols, to + i, to_stride, rows - i);
  // What no square has reached.
  const Index squares = zeros ? rows : i;
  for (Index j = cols / w * w; j < cols; ++j) {
    for (Index r = 0; r < squares; ++r)
      to[j * to_stride + r] = from[r * from_stride + j];
    if (zeros)
      std::fill(
          to + j * to_stride + rows, to + j * to_stride + round_up(rows, w), 0);
  }
  for (Index r = squares; r < rows; ++r)
    for (Index j = 0; j < cols; ++j)
      to[j * to_stride + r] = from[r * from_stride + j];
}

template <class T>
void to_rows(BatchIn<T> from, Rows<T> to) {
  SUITE_CHECK(from.rows() == to.rows && from.cols() == to.samples,
              "rows and batch differ in shape");
  transpose(from.data(),
            from.outerStride(),
            from.cols(),
            from.rows(),
            to.data,
            to.stride,
            Behind::zeros);
}

template <class T>
void from_rows(Rows<const T> from, BatchOut<T> to) {
  SUITE_CHECK(to.rows() == from.rows && to.cols() == from.samples,
              "rows and batch differ in shape");
  transpose(from.data,
            from.stride,
            from.rows,
            from.samples,
            to.data(),
            to.outerStride());
}

template <class T>
void add_to_rows(Rows<const T> more, Rows<T> to) {
  using V = NarrowPack<T>;
  for (Index i = 0; i < to.rows; ++i)
    for (Index j = 0; j < to.width; j += kNarrowLanes<T>)
      store(to.row(i) + j, load<V>(to.row(i) + j) + load<V>(more.row(i) + j));
}

namespace {

/// sums[q] = sum of the lanes of v[q] as `sum_of` makes it, of four at once.
PHYSINV_LANES void sums_of(const NarrowPack<double> (&v)[4], double* sums) {
  const auto pairs = [](auto a, auto b) {
    return __builtin_shufflevector(a, b, 0, 1, 4, 5) +
           __builtin_shufflevector(a, b, 2, 3, 6, 7);
  };
  const auto a = pairs(v[0], v[1]), b = pairs(v[2], v[3]);
  store(sums,
        __builtin_shufflevector(a, b, 0, 2, 4, 6) +
            __builtin_shufflevector(a, b, 1, 3, 5, 7));
}
PHYSINV_LANES void sums_of(const NarrowPack<float> (&v)[4], float* sums) {
  const auto halves = [](auto a, auto b) {
    return __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11) +
           __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
  };
  const auto a = halves(v[0], v[1]), b = halves(v[2], v[3]);
  const auto pairs = __builtin_shufflevector(a, b, 0, 1, 4, 5, 8, 9, 12, 13) +
                     __builtin_shufflevector(a, b, 2, 3, 6, 7, 10, 11, 14, 15);
  store(sums,
        __builtin_shufflevector(pairs, pairs, 0, 2, 4, 6) +
            __builtin_shufflevector(pairs, pairs, 1, 3, 5, 7));
}

}  // namespace

template <class T>
void row_sums(Rows<const T> x, T* sums) {
  using V = NarrowPack<T>;
  constexpr Index w = kNarrowLanes<T>, kRows = 4;
  const Index full = x.samples / w * w;
  // The last lanes are there, but padding: a comparison masks what they hold.
  V lane{};
  for (Index l = 0; l < w; ++l) lane[l] = static_cast<T>(l);
  const auto valid = lane < broadcast<V>(static_cast<T>(x.samples - full));
  // Rows are summed together, as one would wait for its own sum at every step.
  for (Index i = 0; i < x.rows; i += kRows) {
    const Index last = std::min(kRows, x.rows - i) - 1;
    const T* rows[kRows];
    V sum[kRows] = {};
#pragma GCC unroll 4
    for (Index q = 0; q < kRows; ++q) rows[q] = x.row(i + std::min(q, last));
    for (Index j = 0; j < full; j += w)
#pragma GCC unroll 4
      for (Index q = 0; q < kRows; ++q) sum[q] += load<V>(rows[q] + j);
    if (full < x.samples)
#pragma GCC unroll 4
      for (Index q = 0; q < kRows; ++q)
        sum[q] += valid ? load<V>(rows[q] + full) : V{};
    T four[kRows];
    sums_of(sum, four);
    std::copy_n(four, last + 1, sums + i);
  }
}

#define PHYSINV_INSTANTIATE(T)                      \
  template decltype(transpose<T>) transpose<T>;     \
  template decltype(to_rows<T>) to_rows<T>;         \
  template decltype(from_rows<T>) from_rows<T>;     \
  template decltype(add_to_rows<T>) add_to_rows<T>; \
  template decltype(row_sums<T>) row_sums<T>;
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
