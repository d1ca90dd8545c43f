/// Dense decompositions, the library's (Eigen), compiled once for registers of
/// any width: half a minute in the compiler, and the same code for all.
#pragma once

#include <memory>

#include "suite/core/batch.h"

namespace physinv::linalg {

/// A = V diag(values) V^T, values ascending.
struct SymmetricEigen {
  Vector<double> values;
  Batch<double> vectors;
};
SymmetricEigen symmetric_eigen(const Batch<double>& a);

/// A = U diag(s) V^T, s descending, as many columns of U and V as of them; by
/// divide and conquer.
struct SingularValues {
  Batch<double> u, v;
  Vector<double> s;
  bool found;
};
SingularValues singular_values(const Batch<double>& a);

/// x with A x = b by an LU decomposition with full pivoting; pivots up to the
/// smaller size of A times the machine epsilon of the largest are zero but for
/// rounding, and their unknowns are zero. Keeps its memory.
template <class T>
class FullyPivoted {
 public:
  FullyPivoted();
  ~FullyPivoted();
  void solve(BatchIn<T> a, VectorIn<T> b, VectorOut<T> x);

 private:
  struct Lu;
  std::unique_ptr<Lu> lu_;
};

extern template class FullyPivoted<float>;
extern template class FullyPivoted<double>;

}  // namespace physinv::linalg
