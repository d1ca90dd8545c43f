/// The Hessian model of L-BFGS-B for one problem (Byrd, Lu, Nocedal, Zhu 1995),
/// compact in the last m pairs of steps s and gradient changes y:
///
///   B = theta I - W M W',   W = (Y, theta S),
///   M = (-D L'; L theta S'S)^-1,
///
/// D and L the diagonal and the strictly lower part of S'Y. Vectors of length
/// 2 pairs() live in the space of W.
#pragma once

#include <span>

#include "suite/core/batch.h"

namespace physinv {

/// Solves (-P R'; R Q) v = b for symmetric P and Q, k x k (their lower parts
/// are read), where P and Q + R P^-1 R' are positive definite: M^-1 above, and
/// its like in a subspace.
class SaddleFactor {
 public:
  void reserve(Index k);
  /// False if rounding has left one of the two not positive definite.
  bool factor(Index k,
              const Batch<double>& p,
              const Batch<double>& r,
              const Batch<double>& q);
  /// v may be b.
  void solve(Index k, const double* b, double* v) const;

 private:
  Batch<double> p_, g_, t_;  // Cholesky factors of P, Q + G'G; G = P^-1/2 R'
};

class LimitedMemory {
 public:
  /// Empty, for d unknowns and at most m pairs.
  void start(Index d, Index m);
  void clear();

  Index pairs() const { return pairs_; }
  double theta() const { return theta_; }

  /// Takes in a step s and a change y with s.y = sy > 0; the oldest of m pairs
  /// leaves. False, and the memory empty, if rounding has left M^-1 singular.
  bool update(const double* step, const double* change, double sy);

  /// out = W'v.
  void project(const double* v, double* out) const;
  /// v += W w.
  void expand(const double* w, double* v) const;
  /// out = row i of W.
  void row(Index i, double* out) const;
  /// out = M w; may be w.
  void middle(const double* w, double* out) const {
    middle_.solve(pairs_, w, out);
  }

  /// r <- (Z'BZ)^-1 r, Z the unit vectors of the free unknowns; r has zeros
  /// elsewhere, and keeps them. False if rounding has left it singular.
  bool solve_free(std::span<const char> free, double* r);

 private:
  double free_dot(std::span<const char> free,
                  bool held,
                  const double* a,
                  const double* b) const;

  /// Of pair j, the oldest being 0.
  const double* s(Index j) const { return s_.col((oldest_ + j) % m_).data(); }
  const double* y(Index j) const { return y_.col((oldest_ + j) % m_).data(); }

  Index d_ = 0, m_ = 0, pairs_ = 0;
  Index oldest_ = 0;  // column of the first pair
  double theta_ = 1;
  Batch<double> s_, y_;         // d x m, in a ring
  Batch<double> ss_, sy_, yy_;  // S'S, S'Y, Y'Y
  Batch<double> p_, r_, q_;     // blocks of a SaddleFactor
  Vector<double> w_;
  SaddleFactor middle_, subspace_;
};

}  // namespace physinv
