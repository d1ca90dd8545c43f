/// How far two densities differ, the long waves counting most: of the discrete
/// Fourier transform D of the difference without its mean,
///
///   L = sum over all modes of sqrt(max(|w D|^2, threshold)),
///   w = exp(-falloff^2 (k^2 + l^2) / (2 cells^2))
///
/// less the floor cells^2 sqrt(threshold), which is there whatever fits.
///
/// A mode below the threshold is a constant and has no derivative. As |D| is at
/// most the sum of all absolute differences, only modes whose w is large enough
/// for that are transformed: 61 of 4096 at most for densities between 0 and 1.
#pragma once

#include <vector>

#include "suite/core/batch.h"

namespace physinv {

class FrequencyLoss {
 public:
  FrequencyLoss(Index cells, double falloff, double threshold);

  /// Of one difference (i, j), j the fastest; d L / d difference goes to
  /// `gradient` unless it is null.
  double operator()(VectorIn<double> difference, double* gradient) const;

  /// What L is where nothing is left to fit.
  double floor() const;

  double weight(Index k, Index l) const;

 private:
  Index cells_;
  double exponent_, least_;
  std::vector<double> cosine_, sine_;  ///< of j / cells turns
};

}  // namespace physinv
