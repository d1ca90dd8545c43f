#include "suite/linalg/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "suite/core/eigen_caches.h"

namespace physinv::linalg {

SymmetricEigen symmetric_eigen(const Batch<double>& a) {
  state_caches();
  const Eigen::SelfAdjointEigenSolver<Batch<double>> parts(a);
  return {parts.eigenvalues(), parts.eigenvectors()};
}

SingularValues singular_values(const Batch<double>& a) {
  state_caches();
  const Eigen::BDCSVD<Batch<double>> svd(
      a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(),
          svd.matrixV(),
          svd.singularValues(),
          svd.info() == Eigen::Success};
}

template <class T>
struct FullyPivoted<T>::Lu {
  Eigen::FullPivLU<Batch<T>> of;
};

template <class T>
FullyPivoted<T>::FullyPivoted() : lu_(std::make_unique<Lu>()) {}

template <class T>
FullyPivoted<T>::~FullyPivoted() = default;

template <class T>
void FullyPivoted<T>::solve(BatchIn<T> a, VectorIn<T> b, VectorOut<T> x) {
  state_caches();
  x = lu_->of.compute(a).solve(b);
}

template class FullyPivoted<float>;
template class FullyPivoted<double>;

}  // namespace physinv::linalg
