/// Powers of an explicit Jacobian: QR of the long side, then an SVD of the
/// small triangular factor. Nothing is squared.
#pragma once

#include <span>
#include <vector>

#include "optimizers/half_inverse/power.h"

namespace physinv::hig {

class ExplicitPower {
 public:
  /// jacobian (m x p, tall or wide), g (m).
  Ending factor(BatchIn<double> jacobian, VectorIn<double> g);

  /// The update itself (p numbers).
  PowerReport apply(const Power& power, VectorOut<double> update) const;

  const Spectrum& spectrum() const { return spectrum_; }

 private:
  /// x <- V, for the singular values and c = U^T h of x = V diag(s) U^T.
  bool decompose(Batch<double>& x, Vector<double>& h);

  Spectrum spectrum_;
  Ending ending_ = Ending::zero;
  Batch<double> right_;  ///< V (p x min(m, p))
};

/// One-sided Jacobi: turns the columns of x (n x n) by plane rotations until
/// they are orthogonal, and `h` (n) like a row of x. Small singular values of
/// a matrix with graded columns come out with high relative accuracy. False
/// after 60 sweeps.
bool orthogonalize_columns(BatchOut<double> x, VectorOut<double> h);

}  // namespace physinv::hig
