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

#include "suite/core/threads.h"
#include "suite/nn/layer_rows.h"

namespace physinv::hig {

class StructuredGram {
 public:
  /// The lower triangle of `gram` (m x m, m = samples rows_per_sample); what
  /// is above keeps its contents. Bits do not depend on threads.
  template <class T>
  void operator()(std::span<const LayerRows<T>> layers,
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

  class Sweep;

  template <class T>
  void pack_all(std::span<const LayerRows<T>> layers,
                Index samples,
                Index rows_per_sample);
  template <class T>
  void add(std::span<const LayerRows<T>> layers,
           Index samples,
           Index rows_per_sample,
           bool first,
           BatchOut<double> gram,
           Threads* threads);
  template <class T>
  void pack(const LayerRows<T>& layer, Index samples, Index rows, Index first);
  template <class T>
  void pack_columns(const LayerRows<T>& layer,
                    Index rows_per_sample,
                    Index rows,
                    Index first);

  std::vector<double> packed_, left_, right_, factors_;
  std::vector<std::vector<double>> expanded_;
  std::vector<Term> terms_;
  Index features_ = 0;
};

}  // namespace physinv::hig
