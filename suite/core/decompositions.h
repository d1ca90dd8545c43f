/// Dense decompositions, the library's (Eigen), compiled once for registers of
/// any width: half a minute in the compiler, and the same code for all.
#pragma once

#include "suite/core/batch.h"

namespace physinv {

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

/// X with A X = B by an LU decomposition with full pivoting; pivots that are
/// zero alone count as zero, and their unknowns are.
template <class T>
Batch<T> solve_fully_pivoted(const Batch<T>& a, const Batch<T>& b);

extern template Batch<float> solve_fully_pivoted(const Batch<float>&,
                                                 const Batch<float>&);
extern template Batch<double> solve_fully_pivoted(const Batch<double>&,
                                                  const Batch<double>&);

}  // namespace physinv
