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

#include <numbers>
#include <vector>

#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/nn/gemm.h"
#include "suite/nn/grid.h"
#include "suite/nn/rows.h"

namespace physinv::nn {

template <class T>
class PlaneModes {
 public:
  /// K and L, the numbers of frequencies.
  PlaneModes(Grid grid, Grid period, Index row_count, Index column_count)
      : grid_(grid),
        row_count_(row_count),
        column_count_(column_count),
        rows_(waves(row_count, period.rows, grid.rows)),
        columns_(waves(column_count, period.columns, grid.columns)) {
    SUITE_CHECK(grid.rows <= period.rows && grid.columns <= period.columns,
                "a field is larger than its period");
  }

  const Grid& grid() const { return grid_; }
  Index cos_row(Index k) const { return k; }
  Index sin_row(Index k) const { return row_count_ + k - 1; }
  Index cos_column(Index l) const { return l; }
  Index sin_column(Index l) const { return column_count_ + l - 1; }
  Index row_sums() const { return 2 * row_count_ - 1; }        ///< values of h
  Index column_sums() const { return 2 * column_count_ - 1; }  ///< values of g

  /// Numbers per position, so that neighbours do not share sets of a cache.
  static Index pitch(Index block) { return row_stride<T>(block); }

  /// t[.][r] from row r of the field.
  void analyse_row(const T* x, Index r, Index block, T* t) const {
    const Index step = pitch(block);
    gemm<T>({.m = column_sums(),
             .n = block,
             .k = grid_.columns,
             .a = columns_.data(),
             .a_row = grid_.columns,
             .a_k = 1,
             .b = x,
             .b_stride = step,
             .c = t + r * step,
             .c_stride = grid_.rows * step});
  }
  /// u[g][.] from t[g][.].
  void analyse_rows(const T* t, Index g, Index block, T* u) const {
    const Index step = pitch(block);
    gemm<T>({.m = row_sums(),
             .n = block,
             .k = grid_.rows,
             .a = rows_.data(),
             .a_row = grid_.rows,
             .a_k = 1,
             .b = t + g * grid_.rows * step,
             .b_stride = step,
             .c = u + g * row_sums() * step,
             .c_stride = step});
  }
  void synthesise_rows(const T* u, Index g, Index block, T* t) const {
    const Index step = pitch(block);
    gemm<T>({.m = grid_.rows,
             .n = block,
             .k = row_sums(),
             .a = rows_.data(),
             .a_row = 1,
             .a_k = grid_.rows,
             .b = u + g * row_sums() * step,
             .b_stride = step,
             .c = t + g * grid_.rows * step,
             .c_stride = step});
  }
  void synthesise_row(const T* t, Index r, Index block, T* x) const {
    const Index step = pitch(block);
    gemm<T>({.m = grid_.columns,
             .n = block,
             .k = column_sums(),
             .a = columns_.data(),
             .a_row = 1,
             .a_k = grid_.columns,
             .b = t + r * step,
             .b_stride = grid_.rows * step,
             .c = x,
             .c_stride = step});
  }

 private:
  /// Cosines of frequencies 0 .. count-1, then sines of 1 .. count-1.
  static std::vector<T> waves(Index count, Index period, Index extent) {
    std::vector<T> all;
    const auto angle = [&](Index k, Index i) {
      return 2 * std::numbers::pi * double(k * i % period) / double(period);
    };
    for (Index k = 0; k < count; ++k)
      for (Index i = 0; i < extent; ++i)
        all.push_back(static_cast<T>(math::cos(angle(k, i))));
    for (Index k = 1; k < count; ++k)
      for (Index i = 0; i < extent; ++i)
        all.push_back(static_cast<T>(math::sin(angle(k, i))));
    return all;
  }

  Grid grid_;
  Index row_count_, column_count_;
  std::vector<T> rows_, columns_;  ///< R[h][r], Q[g][q]
};

}  // namespace physinv::nn
