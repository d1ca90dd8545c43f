/// Rows: how activations lie inside a network. Row = feature, columns =
/// samples, contiguous and padded to whole narrow packs. Batches (one
/// sample = one column) are transposed only at the network's boundary.
///
/// The padding holds finite garbage in activations and zeros in cotangents;
/// no result may depend on it.
#pragma once

#include <cstddef>
#include <type_traits>

#include "suite/core/batch.h"
#include "suite/core/simd/pack.h"
#include "suite/core/workspace.h"

namespace physinv::nn {

/// Distance between rows of `width` numbers. From three cache lines on an odd
/// number of them: with 512-byte rows a column of 128 features would fall into
/// 8 sets of the L1. With two lines it fits, and a third of the memory is
/// saved.
template <class T>
constexpr Index row_stride(Index width) {
  constexpr Index line = 2 * kNarrowLanes<T>;
  if (width <= line) return width;
  const Index lines = (width + line - 1) / line;
  return (lines <= 2 ? lines : lines | 1) * line;
}

/// View of features x samples. `T` may be const.
template <class T>
struct Rows {
  T* data = nullptr;
  Index rows = 0, samples = 0, width = 0, stride = 0;

  Rows() = default;
  Rows(T* d, Index r, Index n)
      : data(d),
        rows(r),
        samples(n),
        width(round_up(n, kNarrowLanes<std::remove_const_t<T>>)),
        stride(row_stride<std::remove_const_t<T>>(width)) {}

  T* row(Index i) const { return data + i * stride; }
  explicit operator bool() const { return data != nullptr; }
  operator Rows<const T>() const requires(!std::is_const_v<T>) {
    return {data, rows, samples};
  }
};

/// Memory for rows, until the scope ends.
template <class T>
Rows<T> take_rows(Workspace& work, Index rows, Index samples) {
  Rows<T> x(nullptr, rows, samples);
  x.data = work.take<T>(x.stride, rows).data();
  return x;
}

/// A slot of a tape as rows, opened for writing.
template <class T>
Rows<T> open_rows(Tape& tape, std::size_t slot, Index rows, Index samples) {
  Rows<T> x(nullptr, rows, samples);
  x.data = tape.slot<T>(slot, x.stride, rows).data();
  return x;
}

/// And as it was left.
template <class T>
Rows<T> kept_rows(const Tape& tape,
                  std::size_t slot,
                  Index rows,
                  Index samples) {
  return {tape.view<T>(slot).data(), rows, samples};
}

/// What a transpose writes behind the last of its rows, up to a whole vector.
enum class Behind { none, zeros };

/// to[j][i] = from[i][j] for i < rows, j < cols.
template <class T>
void transpose(const T* from,
               Index from_stride,
               Index rows,
               Index cols,
               T* to,
               Index to_stride,
               Behind behind = Behind::none);

/// Samples as columns -> rows; the padding becomes zero.
template <class T>
void to_rows(BatchIn<T> from, Rows<T> to);

template <class T>
void from_rows(Rows<const T> from, BatchOut<T> to);

/// to += more, padding included.
template <class T>
void add_to_rows(Rows<const T> more, Rows<T> to);

/// sums[i] = sum of row i over its samples. Lane l adds samples l, l + W, ...;
/// the lanes are then added pairwise, so the order is that of n alone.
template <class T>
void row_sums(Rows<const T> x, T* sums);

}  // namespace physinv::nn
