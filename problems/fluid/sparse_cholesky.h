/// Solves A x = b for a symmetric positive definite sparse A, factored once:
/// right-hand sides side by side in lanes, so that each entry of the factor is
/// read once for all of them. Sums have four parts in a fixed order.
#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

#include "suite/core/simd/pack.h"

namespace physinv::fluid {

template <class T>
class SparseCholesky {
 public:
  /// Factored in double, in the order of approximate minimum degree.
  explicit SparseCholesky(const Eigen::SparseMatrix<double>& a);

  Index size() const { return static_cast<Index>(inverse_diagonal_.size()); }
  /// Numbers off the diagonal of the factor.
  Index entries() const { return static_cast<Index>(rows_.value.size()); }
  /// The place of unknown i in x.
  Index position(Index i) const { return position_[i]; }

  /// x = b on entry; both in the order of `position`.
  template <class P>
  void solve(P* x) const {
    const Index n = size();
    for (Index i = 0; i < n; ++i)
      x[i] = rows_.subtract(i, x) * inverse_diagonal_[i];
    for (Index i = n; i-- > 0;)
      x[i] = columns_.subtract(i, x) * inverse_diagonal_[i];
  }

 private:
  /// The factor below its diagonal, negative, by rows or by columns.
  struct Lines {
    std::vector<std::int32_t> start, index;
    std::vector<T> value;

    /// x[i] minus the line's product with x.
    template <class P>
    PHYSINV_LANES P subtract(Index i, const P* x) const {
      P sum[4] = {x[i], P{}, P{}, P{}};
      std::int32_t k = start[i];
      const std::int32_t end = start[i + 1];
      for (; k + 4 <= end; k += 4)
        for (int part = 0; part < 4; ++part)
          sum[part] =
              fma_lanes(P{} + value[k + part], x[index[k + part]], sum[part]);
      for (; k < end; ++k)
        sum[0] = fma_lanes(P{} + value[k], x[index[k]], sum[0]);
      return (sum[0] + sum[1]) + (sum[2] + sum[3]);
    }
  };

  Lines rows_, columns_;
  std::vector<T> inverse_diagonal_;
  std::vector<Index> position_;
};

extern template class SparseCholesky<float>;
extern template class SparseCholesky<double>;

}  // namespace physinv::fluid
