#include "tests/support/singular_values.h"

#include <Eigen/SVD>

namespace physinv::test {

linalg::SingularValues jacobi_singular_values(const Batch<double>& a) {
  const Eigen::JacobiSVD<Batch<double>> svd(
      a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.matrixV(), svd.singularValues(), true};
}

}  // namespace physinv::test
