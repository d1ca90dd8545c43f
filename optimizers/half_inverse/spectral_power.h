/// The fast path: powers of J from J J^T by one tridiagonalisation and no
/// eigenvectors, 4/3 m^3 + O(m^2) flops, any number of settings.
///
///   1. reflector P with P g = alpha e1, G' = P G P
///   2. G' = Q T Q^T with Q e1 = e1
///   3. T = W diag(lambda) W^T, c = alpha W^T e1, rotations recorded
///   4. v = P Q W diag(f(lambda)) c
///
/// Squaring costs digits: singular values below 1e-8 s_max are noise. The
/// report's `error` says what that does to the update at hand.
#pragma once

#include <limits>
#include <span>

#include "optimizers/half_inverse/power.h"
#include "suite/linalg/tridiagonal_qr.h"
#include "suite/linalg/tridiagonalize.h"

namespace physinv::hig {

class SpectralPower {
 public:
  explicit SpectralPower(Threads* threads = nullptr)
      : threads_(threads), reduction_(threads) {}

  /// G = J J^T (m x m, only the lower triangle is read), g (m).
  /// `gram_noise`: 2-norm error of G over that of G, in units of the machine
  /// epsilon; 1 suits a G that was summed in double.
  Ending factor(BatchIn<double> gram,
                VectorIn<double> g,
                double gram_noise = 1,
                linalg::Stages stages = linalg::Stages::automatic);

  /// v of power.h for the matrix factored last; zero unless that ended ok, and
  /// where the update's `error` exceeds `most`: the way back is left out then.
  PowerReport apply(
      const Power& power,
      VectorOut<double> v,
      double most = std::numeric_limits<double>::infinity()) const;

  /// v <- U v, from the order of the spectrum to the rows of G.
  void leave_eigenbasis(VectorOut<double> v) const;
  /// The columns of U that are listed.
  void directions(std::span<const Index> which, BatchOut<double> out) const;

  Ending ending() const { return ending_; }
  const Spectrum& spectrum() const { return spectrum_; }
  Index rotations() const { return qr_.rotations(); }
  std::size_t bytes() const { return reduction_.bytes() + qr_.bytes(); }

 private:
  Threads* threads_;
  linalg::Tridiagonalize reduction_;
  linalg::TridiagonalQr qr_;
  linalg::SymmetricProduct product_;
  Spectrum spectrum_;
  Ending ending_ = Ending::zero;
  Vector<double> u_, gu_, e_;  // padded; P = I - 2 u u^T
};

/// Whether every entry of the lower triangle is finite; the largest magnitude
/// in `largest`.
bool finite_lower(BatchIn<double> a, double& largest);

}  // namespace physinv::hig
