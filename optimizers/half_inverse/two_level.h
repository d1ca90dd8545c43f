/// Powers of J from J J^T where squaring loses too much:
/// the eigenvectors of the small singular values are handled through
/// W2 = J^T U2, so that nothing below 1e-4 s_max is squared twice.
///
/// Resolves s down to about 1e-12 s_max. Costs a full eigendecomposition of
/// G and 2 m p k2 + O(k2^3) flops more, k2 = number of s <= 1e-4 s_max.
#pragma once

#include <functional>

#include "optimizers/half_inverse/power.h"

namespace physinv::hig {

/// out (p x k) = J^T u for u (m x k).
using Pullback = std::function<void(BatchIn<double> u, BatchOut<double> out)>;

class TwoLevelPower {
 public:
  /// As SpectralPower::factor; `parameters` is p.
  Ending factor(BatchIn<double> gram,
                VectorIn<double> g,
                Index parameters,
                const Pullback& pullback,
                double gram_noise = 1);

  PowerReport apply(const Power& power, VectorOut<double> v) const;

  const Spectrum& spectrum() const { return spectrum_; }

 private:
  Spectrum spectrum_;
  Ending ending_ = Ending::zero;
  Batch<double> u_;  ///< columns in the order of the spectrum
};

}  // namespace physinv::hig
