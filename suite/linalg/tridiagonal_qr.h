/// Implicit QR of a symmetric tridiagonal matrix that keeps its rotations
/// instead of eigenvectors: T = W diag(lambda) W^T, W applied to single
/// vectors at two multiply-adds a rotation.
///
/// A sweep is one chain of square roots and divisions, so several run at once,
/// each two rows behind the one before. Their shifts are the eigenvalues of
/// the last rows; Wilkinson's for single sweeps of short or stubborn blocks.
#pragma once

#include <vector>

#include "suite/core/batch.h"

namespace physinv::linalg {

class TridiagonalQr {
 public:
  /// d (n) becomes the eigenvalues in no order, e (n - 1) is used up, and x
  /// becomes W^T x. e_i counts as zero where
  /// |e_i| <= eps (|d_i| + |d_i+1|), which keeps the small eigenvalues of a
  /// graded matrix. False after 60 n sweeps without an end.
  bool run(VectorOut<double> d, VectorOut<double> e, VectorOut<double> x);

  /// x <- W x: the recorded rotations backwards. X is double, or Pack8 for
  /// eight vectors side by side. Rows
  /// before `first` are zero, and rotations of zeros are left out.
  template <class X>
  void apply(X* x, Index first = 0) const;

  Index rotations() const { return rotations_; }
  Index sweeps() const { return sweeps_; }
  std::size_t bytes() const {
    return record_.capacity() * sizeof(double) +
           rounds_.capacity() * sizeof(Round);
  }

 private:
  /// One sweep, or as many as run at once, of the rows start ... end.
  struct Round {
    Index start, end, sweeps;
    /// Cosines and sines, those of one step next to each other.
    std::size_t numbers() const;
  };
  /// The room for its record.
  double* begin(const Round& round);
  void single(double* d, double* e, double* x, Index start, Index end);
  bool several(double* d, double* e, double* x, Index start, Index end);

  std::vector<Round> rounds_;
  std::vector<double> record_;  ///< longer than `used_` after a shorter run
  std::size_t used_ = 0;
  Index rotations_ = 0, sweeps_ = 0;
};

}  // namespace physinv::linalg
