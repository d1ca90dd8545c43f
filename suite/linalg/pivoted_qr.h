/// A P = Q R of a tall matrix by Householder reflectors; each step takes the
/// column with the longest remainder (Businger and Golub 1965), so that the
/// diagonal of R does not grow. 2 m n^2 - 2/3 n^3 flops.
#pragma once

#include <vector>

#include "suite/core/batch.h"

namespace physinv::linalg {

class PivotedQr {
 public:
  /// a is m x n, m >= n, finite and of entries near 1 (`reflect`).
  explicit PivotedQr(Batch<double> a);

  /// n x n, zeros below the diagonal.
  const Batch<double>& r() const { return r_; }
  /// Column j of A P is column order(j) of A.
  Index order(Index j) const { return order_[static_cast<std::size_t>(j)]; }

  void apply_q(BatchOut<double> x) const;             ///< x (m x k) <- Q x
  void apply_q_transposed(BatchOut<double> x) const;  ///< x <- Q^T x

 private:
  void move_longest_to(Index k);
  void shorten(Index k, Index j);

  Batch<double> v_, r_;  ///< reflectors below the diagonal of v
  Vector<double> tau_;
  Vector<double> length_, measured_;  ///< of remainders: updated, last measured
  std::vector<Index> order_;
};

}  // namespace physinv::linalg
