/// G = J J^T of a network's stacked Jacobian without the Jacobian.
///
/// Rows are sample-major, row = sample |y| + k. A row's part of a dense layer
/// is (a outer B, B), a the layer's input and B the cotangent, so
///
///   G = sum over layers of (B^T B) .* ((A^T A + 1) expanded to |y| x |y|)
///
/// with features x samples A and features x rows B: m^2 sum(outputs) flops
/// instead of m^2 p. Sums in double, one by one in the order of the features;
/// the factor is applied while a tile is in registers.
#pragma once

#include <span>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/threads.h"

namespace physinv::hig {

template <class T>
struct GramLayer {
  const T* a = nullptr;  ///< A(i, sample) = a[i * a_stride + sample]
  Index inputs = 0, a_stride = 0;
  const T* b = nullptr;  ///< B(o, row) = b[o * b_stride + row]
  Index outputs = 0, b_stride = 0;
  bool bias = true;  ///< the layer has a bias: the + 1
};

class StructuredGram {
 public:
  /// The lower triangle of `gram` (m x m, m = samples rows_per_sample); what
  /// is above keeps its contents. Bits do not depend on threads.
  template <class T>
  void operator()(std::span<const GramLayer<T>> layers,
                  Index samples,
                  Index rows_per_sample,
                  BatchOut<double> gram,
                  Threads* threads = nullptr);

 private:
  template <class T>
  void pack(std::span<const GramLayer<T>> layers, Index samples, Index rows);

  std::vector<double> packed_, inputs_, factors_;
  std::vector<std::vector<double>> expanded_;
  std::vector<Index> begin_;
};

extern template void StructuredGram::operator()<float>(
    std::span<const GramLayer<float>>,
    Index,
    Index,
    BatchOut<double>,
    Threads*);
extern template void StructuredGram::operator()<double>(
    std::span<const GramLayer<double>>,
    Index,
    Index,
    BatchOut<double>,
    Threads*);

}  // namespace physinv::hig
