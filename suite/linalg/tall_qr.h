/// R of a tall matrix by Householder reflectors; Q is not kept.
#pragma once

#include "suite/core/batch.h"
#include "suite/core/workspace.h"

namespace physinv::linalg {

/// Columns of a tall matrix, padded and aligned for `triangularize`.
class TallColumns {
 public:
  /// Opens rows x columns numbers; their values are undefined, the padding
  /// behind each column is zero.
  void open(Index rows, Index columns);
  Index rows() const { return rows_; }
  Index columns() const { return columns_; }
  double* column(Index j) { return data_ + j * stride_; }
  const double* column(Index j) const { return data_ + j * stride_; }
  bool finite() const;
  std::size_t bytes() const { return memory_.bytes(); }

 private:
  Buffer memory_;
  double* data_ = nullptr;
  Index rows_ = 0, columns_ = 0, stride_ = 0;
};

/// The first `pivots` columns of `a` (rows >= pivots) become upper triangular;
/// the same reflectors act on the others. On return r (pivots x columns) is
/// the top of the result and `a` is used up. Panels of four reflectors; the
/// error of every column is a few eps of its own norm. r is NaN if `a` is not
/// finite.
void triangularize(TallColumns& a, Index pivots, BatchOut<double> r);

}  // namespace physinv::linalg
