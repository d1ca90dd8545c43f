#include "suite/core/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace physinv {

SymmetricEigen symmetric_eigen(const Batch<double>& a) {
  const Eigen::SelfAdjointEigenSolver<Batch<double>> parts(a);
  return {parts.eigenvalues(), parts.eigenvectors()};
}

SingularValues singular_values(const Batch<double>& a) {
  const Eigen::BDCSVD<Batch<double>> svd(
      a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(),
          svd.matrixV(),
          svd.singularValues(),
          svd.info() == Eigen::Success};
}

template <class T>
Batch<T> solve_fully_pivoted(const Batch<T>& a, const Batch<T>& b) {
  Eigen::FullPivLU<Batch<T>> lu;
  lu.setThreshold(T(0));
  lu.compute(a);
  return lu.solve(b);
}

template Batch<float> solve_fully_pivoted(const Batch<float>&,
                                          const Batch<float>&);
template Batch<double> solve_fully_pivoted(const Batch<double>&,
                                           const Batch<double>&);

}  // namespace physinv
