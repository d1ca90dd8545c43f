/// One power of a tall Jacobian with few columns; nothing is squared.
///
///   1. triangle R of [J g] by Householder panels (tall_qr.h)
///   2. R = P L Q^T, L bidiagonal, P^T h along e1 (bidiagonal.h)
///   3. the singular values above the cut and their vectors, many at a time
///      (bidiagonal_spectrum.h)
///
/// Where those lie too close to each other, or the cut is below what step 3 is
/// good for, ExplicitPower takes the triangle.
#pragma once

#include "optimizers/half_inverse/explicit_power.h"
#include "suite/linalg/bidiagonal.h"
#include "suite/linalg/bidiagonal_spectrum.h"
#include "suite/linalg/tall_qr.h"

namespace physinv::hig {

class TallPower {
 public:
  /// a = [J g] with as many columns as `update` and one more, rows >= columns
  /// of J; it is used up.
  PowerReport operator()(linalg::TallColumns& a,
                         const Power& power,
                         VectorOut<double> update);

  /// r = [R h]: J = U R and h = U^T g for some U with orthonormal columns.
  PowerReport of_triangle(BatchIn<double> r,
                          const Power& power,
                          VectorOut<double> update);

  /// Updates that ExplicitPower had to do.
  Index fallbacks() const { return fallbacks_; }
  /// Of the last update: steps 2 and 3 made it, so that no SVD was needed;
  /// they were begun and given up.
  bool spared() const { return spared_; }
  bool abandoned() const { return abandoned_; }
  std::size_t bytes() const;

 private:
  bool by_lanes(const Power& power,
                VectorOut<double> update,
                PowerReport& report);

  Batch<double> top_, r_;
  Vector<double> h_, weights_;
  double scale_ = 1;
  linalg::Bidiagonal bidiagonal_;
  linalg::BidiagonalSpectrum lanes_;
  Spectrum spectrum_;
  ExplicitPower explicit_;
  Index fallbacks_ = 0;
  bool spared_ = false, abandoned_ = false;
};

}  // namespace physinv::hig
