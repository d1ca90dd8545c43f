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
///
/// A convolution is the sum of that over pairs of positions p, q, with A_p^T
/// A_q and B_p^T B_q: P^2 outputs m^2 flops. With many positions its explicit
/// columns, sum over p of (a_p outer B_p, B_p), take fewer: (inputs + 1)
/// outputs m^2.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "suite/core/network.h"
#include "suite/core/threads.h"

namespace physinv::hig {

template <class T>
struct GramLayer {
  const T* a = nullptr;  ///< A(i, sample) = a[i * a_stride + sample]
  Index inputs = 0, a_stride = 0;
  const T* b = nullptr;  ///< B(o, row) = b[o * b_stride + row]
  Index outputs = 0, b_stride = 0;
  bool bias = true;              ///< the layer has a bias: the + 1
  Index positions = 1;           ///< of a convolution
  Index a_step = 0, b_step = 0;  ///< features from a position to the next

  Index columns() const { return (inputs + (bias ? 1 : 0)) * outputs; }
  /// Whether its own columns are cheaper than pairs of positions.
  bool written_out() const {
    return positions > 1 && columns() <= positions * positions * outputs;
  }
};

template <class T>
GramLayer<T> gram_layer(const LayerRows<T>& l) {
  return {.a = l.a,
          .inputs = l.inputs,
          .a_stride = l.a_stride,
          .b = l.b,
          .outputs = l.outputs,
          .b_stride = l.b_stride,
          .positions = l.positions,
          .a_step = l.a_step,
          .b_step = l.b_step};
}

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

  std::size_t bytes() const;

 private:
  /// B_p^T B_q of packed features [row, row + depth) and [column, column +
  /// depth), times a factor.
  struct Term {
    Index row, column, depth;
  };

  template <class T>
  void add(std::span<const GramLayer<T>> layers,
           Index samples,
           Index rows_per_sample,
           bool first,
           BatchOut<double> gram,
           Threads* threads);
  template <class T>
  void pack(const GramLayer<T>& layer, Index samples, Index rows, Index first);
  template <class T>
  void pack_columns(const GramLayer<T>& layer,
                    Index rows_per_sample,
                    Index rows,
                    Index first);

  std::vector<double> packed_, left_, right_, factors_;
  std::vector<std::vector<double>> expanded_;
  std::vector<Term> terms_;
  Index features_ = 0;
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
