#include "problems/fluid/sparse_cholesky.h"

#include <Eigen/SparseCholesky>

#include "suite/core/check.h"

namespace physinv::fluid {

template <class T>
SparseCholesky<T>::SparseCholesky(const Eigen::SparseMatrix<double>& a) {
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(a);
  SUITE_CHECK(factor.info() == Eigen::Success,
              "the matrix is not positive definite");
  const Eigen::SparseMatrix<double> lower = factor.matrixL();
  const Eigen::SparseMatrix<double> upper = lower.transpose();
  const Index n = a.rows();
  for (Index i = 0; i < n; ++i) {
    position_.push_back(factor.permutationP().indices()(i));
    inverse_diagonal_.push_back(static_cast<T>(1 / lower.coeff(i, i)));
  }
  const auto fill = [&](Lines& lines, const auto& m) {
    for (Index i = 0; i < n; ++i) {
      lines.start.push_back(static_cast<std::int32_t>(lines.value.size()));
      for (Eigen::SparseMatrix<double>::InnerIterator it(m, i); it; ++it) {
        if (it.row() == it.col()) continue;
        lines.index.push_back(static_cast<std::int32_t>(it.index()));
        lines.value.push_back(static_cast<T>(-it.value()));
      }
    }
    lines.start.push_back(static_cast<std::int32_t>(lines.value.size()));
  };
  fill(rows_, upper), fill(columns_, lower);
}

template class SparseCholesky<float>;
template class SparseCholesky<double>;

}  // namespace physinv::fluid
