/// G = Q T Q^T with Q e1 = e1: a symmetric matrix to tridiagonal form by
/// reflectors that leave the first coordinate alone.
///
/// One stage (panels, as LAPACK's dsytrd): half of the 4/3 m^3 flops are
/// matrix-vector products, so it is bound by memory once the matrix leaves
/// the caches. Two stages (dense -> band of width 32 -> tridiagonal): all
/// but O(m^2) are matrix products; the second reduction is cheap because a
/// single vector, not a basis, is carried back.
#pragma once

#include <vector>

#include "suite/core/buffer.h"
#include "suite/linalg/band.h"
#include "suite/linalg/symmetric_update.h"

namespace physinv::linalg {

enum class Stages { automatic, one, two };

class Tridiagonalize {
 public:
  explicit Tridiagonalize(Threads* threads = nullptr) : threads_(threads) {}

  /// Storage for the next matrix; fill its upper memory triangle.
  Symmetric matrix(Index n);

  /// Overwrites the matrix by its reflectors. Bits depend on the matrix and
  /// `stages` only.
  void reduce(Stages stages = Stages::automatic);

  const Vector<double>& diagonal() const { return d_; }
  const Vector<double>& off_diagonal() const { return e_; }

  /// x <- Q x. X is double, or Pack8 for
  /// eight vectors side by side.
  template <class X>
  void apply(X* x) const;

  std::size_t bytes() const { return memory_.bytes() + band_.bytes(); }

 private:
  void one_stage();
  void two_stage();
  void panel(Index first, Index count);
  void factor_panel(Index first, Index start);
  void triangular_factor(Index start, const double* v, double* s) const;
  void multiply_panel(Index start, const double* v, double* av);
  void update_behind(Index start);

  Threads* threads_;
  Buffer memory_;
  Symmetric a_{};
  bool two_ = false;
  Vector<double> d_, e_, tau_;
  Buffer v_, w_, x_, y_;
  SymmetricProduct product_;
  RankUpdate update_;
  BandReduction band_;
  std::vector<double> parts_;
};

}  // namespace physinv::linalg
