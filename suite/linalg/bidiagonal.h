/// Bidiagonal form of a small square matrix from a vector on the left:
///
///   R = P L Q^T,  P^T h = alpha e1,  L lower bidiagonal
///
/// so that the left singular vectors u of L are needed in one entry only:
/// u_1 = a_1 v_1 / s (Golub and Kahan 1965; as LSQR does by Lanczos).
#pragma once

#include "suite/core/batch.h"
#include "suite/core/workspace.h"

namespace physinv::linalg {

class Bidiagonal {
 public:
  /// R (n x n), h (n). Both are left as they are.
  void reduce(BatchIn<double> r, VectorIn<double> h);

  double alpha() const { return alpha_; }
  /// L_ii (n) and L_i+1,i (n - 1).
  const Vector<double>& diagonal() const { return a_; }
  const Vector<double>& below() const { return b_; }

  /// x <- Q x.
  void apply(VectorOut<double> x) const;

 private:
  Index stride_ = 0;
  double alpha_ = 0;
  Vector<double> a_, b_, tau_;
  Buffer memory_, reflectors_;
};

}  // namespace physinv::linalg
