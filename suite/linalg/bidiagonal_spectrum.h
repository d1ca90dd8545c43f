/// Singular values and right singular vectors of a small lower bidiagonal
/// matrix L, many at a time: each lane of a register looks for its own value.
///
///   1. bisection with counts of negative pivots of L^T L - x until a value
///      is alone (differential stationary qd transform, no squares summed)
///   2. Rayleigh quotients with twisted factorisations, cubic convergence
///      (Dhillon and Parlett 2004)
///
/// Small values come out with high relative accuracy. Vectors of values that
/// lie close to each other do not come out orthogonal: that is measured and
/// reported.
#pragma once

#include "suite/core/batch.h"
#include "suite/core/workspace.h"

namespace physinv::linalg {

class BidiagonalSpectrum {
 public:
  /// a: L_ii (n), b: L_i+1,i (n - 1), entries of size 1. Looks for all values
  /// above `floor` > 0. False if they are too close to each other.
  bool find(VectorIn<double> a, VectorIn<double> b, double floor);

  /// Values found, downwards.
  Index count() const { return count_; }
  double lambda(Index i) const { return lambda_(i); }  ///< s_i^2
  /// First entry of the right vector of length 1.
  double first(Index i) const { return first_(i); }
  /// sum_i w_i v_i for the first w.size() values.
  void combine(VectorIn<double> w, VectorOut<double> out) const;

 private:
  void count_above(const double* x, double* counts, Index groups) const;
  void isolate(double floor2, double top);
  /// Values that are refined together.
  struct Twins;
  [[gnu::always_inline]] void bracket(Twins& t, Index lane) const;
  [[gnu::always_inline]] void factor_down(Twins& t) const;
  [[gnu::always_inline]] void factor_up(Twins& t) const;
  [[gnu::always_inline]] void solve_up(Twins& t) const;
  [[gnu::always_inline]] void solve_down(Twins& t) const;
  void keep(const Twins& t, Index lane);
  void refine(Index lane);
  bool orthogonal();

  Index n_ = 0, count_ = 0, groups_ = 0;
  Vector<double> lambda_, first_;
  Buffer memory_, vectors_;
  double *q_ = nullptr, *e_ = nullptr;  ///< squares, in reverse order
  double* off_ = nullptr;               ///< a b, in reverse order
  double *low_ = nullptr, *high_ = nullptr, *residual_ = nullptr;
  Batch<double> v_;  ///< stride x count, vectors as columns, reversed
};

}  // namespace physinv::linalg
