#include "suite/nn/lanes.h"

#include <algorithm>

#include "suite/core/check.h"
#include "suite/nn/vector.h"

namespace physinv::nn {
namespace {

using F = Simd<float, kNarrow>;
using D = Simd<double, kNarrow>;

F low(F a, F b) {
  return __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
}
F high(F a, F b) {
  return __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
}
D low(D a, D b) { return __builtin_shufflevector(a, b, 0, 4, 1, 5); }
D high(D a, D b) { return __builtin_shufflevector(a, b, 2, 6, 3, 7); }

/// A square of one vector per row: log2(W) perfect shuffles are a transpose.
template <class T>
void transpose_square(const T* from,
                      Index from_stride,
                      T* to,
                      Index to_stride) {
  using V = Simd<T, kNarrow>;
  constexpr int w = static_cast<int>(kLanes<T>);
  V a[w], b[w];
#pragma GCC unroll 8
  for (int i = 0; i < w; ++i) a[i] = load<V>(from + i * from_stride);
#pragma GCC unroll 3
  for (int s = 1; s < w; s *= 2) {
#pragma GCC unroll 8
    for (int i = 0; i < w / 2; ++i) {
      b[2 * i] = low(a[i], a[i + w / 2]);
      b[2 * i + 1] = high(a[i], a[i + w / 2]);
    }
#pragma GCC unroll 8
    for (int i = 0; i < w; ++i) a[i] = b[i];
  }
#pragma GCC unroll 8
  for (int i = 0; i < w; ++i) store(to + i * to_stride, a[i]);
}

}  // namespace

template <class T>
void transpose(const T* from,
               Index from_stride,
               Index rows,
               Index cols,
               T* to,
               Index to_stride) {
  constexpr Index w = kLanes<T>;
  const Index full_rows = rows / w * w, full_cols = cols / w * w;
  for (Index i = 0; i < full_rows; i += w)
    for (Index j = 0; j < full_cols; j += w)
      transpose_square(from + i * from_stride + j,
                       from_stride,
                       to + j * to_stride + i,
                       to_stride);
  for (Index i = 0; i < rows; ++i)
    for (Index j = i < full_rows ? full_cols : 0; j < cols; ++j)
      to[j * to_stride + i] = from[i * from_stride + j];
}

template <class T>
void to_lanes(BatchIn<T> from, Lanes<T> to) {
  SUITE_CHECK(from.rows() == to.rows && from.cols() == to.samples,
              "lanes and batch differ in shape");
  transpose(from.data(),
            from.outerStride(),
            from.cols(),
            from.rows(),
            to.data,
            to.stride);
  for (Index i = 0; i < to.rows; ++i)
    std::fill(to.row(i) + to.samples, to.row(i) + to.width, T(0));
}

template <class T>
void from_lanes(Lanes<const T> from, BatchOut<T> to) {
  SUITE_CHECK(to.rows() == from.rows && to.cols() == from.samples,
              "lanes and batch differ in shape");
  transpose(from.data,
            from.stride,
            from.rows,
            from.samples,
            to.data(),
            to.outerStride());
}

template <class T>
void row_sums(Lanes<const T> x, T* sums) {
  using V = Simd<T, kNarrow>;
  constexpr Index w = kLanes<T>;
  const Index full = x.samples / w * w;
  // The last lanes are there, but padding: a comparison masks what they hold.
  V lane{};
  for (Index l = 0; l < w; ++l) lane[l] = static_cast<T>(l);
  const auto valid = lane < broadcast<V>(static_cast<T>(x.samples - full));
  for (Index i = 0; i < x.rows; ++i) {
    const T* row = x.row(i);
    V sum{};
    for (Index j = 0; j < full; j += w) sum += load<V>(row + j);
    if (full < x.samples) sum += valid ? load<V>(row + full) : V{};
    for (Index half = w / 2; half > 0; half /= 2)
      for (Index l = 0; l < half; ++l) sum[l] += sum[l + half];
    sums[i] = sum[0];
  }
}

#define PHYSINV_INSTANTIATE(T)                                          \
  template void transpose<T>(const T*, Index, Index, Index, T*, Index); \
  template void to_lanes<T>(BatchIn<T>, Lanes<T>);                      \
  template void from_lanes<T>(Lanes<const T>, BatchOut<T>);             \
  template void row_sums<T>(Lanes<const T>, T*);
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
