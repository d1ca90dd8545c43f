/// Implicit QR of a symmetric tridiagonal matrix that keeps its rotations
/// instead of eigenvectors: T = W diag(lambda) W^T, W applied to single
/// vectors at two multiply-adds a rotation.
#pragma once

#include <vector>

#include "suite/core/batch.h"

namespace physinv::hig {

class TridiagonalQr {
 public:
  /// d (n) becomes the eigenvalues in no order, e (n - 1) is used up, and x
  /// becomes W^T x. Wilkinson shifts; e_i counts as zero where
  /// |e_i| <= eps (|d_i| + |d_i+1|), which keeps the small eigenvalues of a
  /// graded matrix. False after 60 n sweeps without an end.
  bool run(VectorOut<double> d, VectorOut<double> e, VectorOut<double> x);

  /// x <- W x: the recorded rotations backwards.
  void apply(VectorOut<double> x) const;

  Index rotations() const { return static_cast<Index>(cosine_.size()); }
  Index sweeps() const { return static_cast<Index>(sweeps_.size()); }
  std::size_t bytes() const {
    return (cosine_.capacity() + sine_.capacity()) * sizeof(double) +
           sweeps_.capacity() * sizeof(Sweep);
  }

 private:
  /// Rotation k of a sweep turns the plane (start + k, start + k + 1).
  struct Sweep {
    Index start, count;
  };
  void sweep(double* d, double* e, double* x, Index start, Index end);

  std::vector<Sweep> sweeps_;
  std::vector<double> cosine_, sine_;
};

}  // namespace physinv::hig
