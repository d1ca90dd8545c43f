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

}  // namespace physinv
