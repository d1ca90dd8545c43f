/// The lowest modes of fields on a plane, by sums over cosines and sines:
/// where 12 of 73 frequencies are wanted, two short matrix products are less
/// work than a transform of all. Real arithmetic throughout:
///
///   u[g][h] = sum over rows r and columns q of R[h][r] Q[g][q] x[r][q]
///
/// where g goes over cos(2 pi l q / columns), l = 0 .. L-1, then over the
/// sines, l = 1 .. L-1; h in the same way over the rows' frequencies 0 .. K-1.
/// Synthesis is the exact transpose.
///
/// The field need not fill the period: it is taken as zero beyond its grid, and
/// synthesised there only.
///
/// Memory: a position is `block` numbers (channels x samples), positions are
/// `pitch` apart: t [g][row], u [g][h], and a row of the plane [column].
#pragma once

#include <vector>

#include "suite/nn/grid.h"
#include "suite/nn/lanes.h"

namespace physinv::nn {

template <class T>
class PlaneModes {
 public:
  /// K and L, the numbers of frequencies.
  PlaneModes(Grid grid, Grid period, Index row_count, Index column_count);

  const Grid& grid() const { return grid_; }
  Index cos_row(Index k) const { return k; }
  Index sin_row(Index k) const { return row_count_ + k - 1; }
  Index cos_column(Index l) const { return l; }
  Index sin_column(Index l) const { return column_count_ + l - 1; }
  Index row_sums() const { return 2 * row_count_ - 1; }        ///< values of h
  Index column_sums() const { return 2 * column_count_ - 1; }  ///< values of g

  /// Numbers per position, so that neighbours do not share sets of a cache.
  static Index pitch(Index block) { return lane_stride<T>(block); }

  /// t[.][r] from row r of the field.
  void analyse_row(const T* x, Index r, Index block, T* t) const;
  /// u[g][.] from t[g][.].
  void analyse_rows(const T* t, Index g, Index block, T* u) const;
  void synthesise_rows(const T* u, Index g, Index block, T* t) const;
  void synthesise_row(const T* t, Index r, Index block, T* x) const;

 private:
  Grid grid_;
  Index row_count_, column_count_;
  std::vector<T> rows_, columns_;  ///< R[h][r], Q[g][q]
};

extern template class PlaneModes<float>;
extern template class PlaneModes<double>;

}  // namespace physinv::nn
