/// Batches: features x samples, one sample is one contiguous column.
/// Byte-equal to a (samples, features) array in HDF5 and NumPy.
#pragma once

#include <Eigen/Core>

namespace physinv {

using Index = Eigen::Index;

template <class T>
using Batch = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

template <class T>
using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;

/// A batch that is read: any matrix or block of columns, without a copy.
template <class T>
using BatchIn = const Eigen::Ref<const Batch<T>>&;

/// A batch that is written; its size is the contract, it is never resized.
template <class T>
using BatchOut = Eigen::Ref<Batch<T>>;

template <class T>
using VectorIn = const Eigen::Ref<const Vector<T>>&;

template <class T>
using VectorOut = Eigen::Ref<Vector<T>>;

/// out = f(a, b), number by number. Columns that follow each other are one
/// array: most are too short to fill registers.
template <class T, class F>
void for_numbers(BatchIn<T> a, BatchIn<T> b, BatchOut<T>& out, F f) {
  const Index rows = a.rows();
  const bool dense = a.outerStride() == rows && b.outerStride() == rows &&
                     out.outerStride() == rows;
  const Index length = dense ? a.size() : rows;
  for (Index first = 0; first < a.size(); first += length) {
    const Index column = first / length;
    const T* const in_a = a.data() + column * a.outerStride();
    const T* const in_b = b.data() + column * b.outerStride();
    T* const to = out.data() + column * out.outerStride();
    for (Index i = 0; i < length; ++i) to[i] = f(in_a[i], in_b[i]);
  }
}

}  // namespace physinv
