/// Clips the gradients of a batch to a percentile of their norms.
///
/// r_i = |g_i|_2, tau = the percentile of the finite r_i (linear interpolation
/// between order statistics, position q (m - 1) of m); g_i *= min(1, tau/r_i).
/// A column that is not finite becomes zero and has no vote. tau = 0 (most
/// columns are zero) makes every column zero.
#pragma once

#include <vector>

#include "suite/core/batch.h"

namespace physinv {

class ClipPercentile {
 public:
  explicit ClipPercentile(double quantile = 0.9) : quantile_(quantile) {}

  /// Clips every column of `gradient` in place and returns tau (0 if no column
  /// is finite). Norms are taken in double. Allocates on growth only.
  template <class T>
  double operator()(BatchOut<T> gradient);

  /// Norms of the last call before clipping; not finite where the column was.
  const std::vector<double>& norms() const { return norms_; }

 private:
  double quantile_;
  std::vector<double> norms_, finite_;
};

extern template double ClipPercentile::operator()<float>(BatchOut<float>);
extern template double ClipPercentile::operator()<double>(BatchOut<double>);

}  // namespace physinv
