/// Powers of J from J J^T where squaring loses too much: the directions U2 of
/// some singular values are taken through W2 = J^T U2, whose Gram matrix
/// resolves them to eps s_max instead of eps s_max^2 / s.
///
/// U2 holds no more than the update needs: the values around the cut, in the
/// narrowest range whose error is expected to be within the tolerance, or
/// everything below 1e-4 s_max, which resolves s down to about 1e-12 s_max.
/// Costs k2 times the way back of the first level, 2 m p k2 flops for W2 and
/// O(k2^3) more, k2 = number of values in the range.
#pragma once

#include <functional>
#include <vector>

#include "optimizers/half_inverse/spectral_power.h"

namespace physinv::hig {

/// out (p x k) = J^T u for u (m x k).
using Pullback = std::function<void(BatchIn<double> u, BatchOut<double> out)>;

class TwoLevelPower {
 public:
  /// `first` factors J J^T; after each time, open().
  explicit TwoLevelPower(const SpectralPower& first, Threads* threads = nullptr)
      : first_(first), second_(threads) {}

  /// Forgets the matrix before.
  void open() { refined_.clear(); }

  /// v of power.h. `parameters` is p. A range that an earlier setting needed,
  /// too, is taken from there.
  PowerReport apply(const Power& power,
                    double tolerance,
                    Index parameters,
                    const Pullback& pullback,
                    VectorOut<double> v);

  /// k2 of the last update.
  Index second_level() const { return inside_; }
  /// Ranges decomposed for the last update that it was not made from.
  Index abandoned() const { return made_ - (made_ > 0 && inside_ > 0); }

 private:
  void arrange(double low, double high);
  PowerReport settle(const Power& power,
                     double most,
                     Index parameters,
                     const Pullback& pullback,
                     VectorOut<double> v);
  Ending refine(Index parameters, const Pullback& pullback);
  void set_inside(VectorIn<double> values);

  const SpectralPower& first_;
  Spectrum spectrum_;         ///< the last inside_ values are U2's
  std::vector<Index> order_;  ///< of the first level's directions in it
  Index inside_ = 0, made_ = 0;
  SpectralPower second_;        ///< of W2^T W2
  std::vector<Index> refined_;  ///< the U2 it stands for
  Vector<double> weights_;
};

}  // namespace physinv::hig
