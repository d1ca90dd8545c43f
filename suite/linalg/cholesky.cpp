#include "suite/linalg/cholesky.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "suite/linalg/householder.h"
#include "suite/linalg/tile_product.h"

namespace physinv::linalg {
namespace {

/// Columns at once: a tile of theirs stays in the L1. A multiple of a tile.
constexpr Index kPanel = 64;
/// Panels that the rest of A waits for: it goes through the caches once for
/// all.
constexpr Index kGroup = 4;
constexpr Index kColumnBlock = 128;  ///< that are updated at once

/// row -= s x from the register that holds column `first` on, for kRows rows x.
template <int kRows>
void subtract(Index first,
              Index n,
              const double* s,
              Index s_step,
              const double* x,
              Index stride,
              double* row) {
  Pack8 by[kRows];
#pragma GCC unroll 4
  for (int i = 0; i < kRows; ++i) by[i] = broadcast(-s[i * s_step]);
  for (Index c = first / kWidth * kWidth; c < n; c += kWidth) {
    Pack8 to = load(row + c);
#pragma GCC unroll 4
    for (int i = 0; i < kRows; ++i)
      to = fma_lanes(by[i], load(x + i * stride + c), to);
    store(row + c, to);
  }
}

/// Columns [begin, end) of L on their own rows, from what earlier panels left
/// of A; `roots` of the pivots, which the diagonal has up to rounding.
bool factor_diagonal(Symmetric a, Index begin, Index end, double* roots) {
  for (Index k = begin; k < end; ++k) {
    double* const row = a.row(k);
    Index j = begin;
    for (; j + 4 <= k; j += 4)
      subtract<4>(k, end, a.row(j) + k, a.stride, a.row(j), a.stride, row);
    for (; j < k; ++j)
      subtract<1>(k, end, a.row(j) + k, a.stride, a.row(j), a.stride, row);
    if (!(row[k] > 0)) return false;
    roots[k - begin] = std::sqrt(row[k]);
    const Pack8 root = broadcast(roots[k - begin]);
    for (Index c = k / kWidth * kWidth; c < end; c += kWidth)
      store(row + c, load(row + c) / root);
  }
  return true;
}

/// Full panels on the rows below their own, and what they take from the rest of
/// A. Their numbers are packed, as rows of A lie pages apart.
class Panels {
 public:
  explicit Panels(Index n) : stride_(round_up(n, kTileColumns) * kPanel) {
    rows_.resize(static_cast<std::size_t>(kGroup * stride_));
    columns_.resize(rows_.size());
  }

  /// Columns [begin, begin + kPanel) of L below its own rows, which are known:
  /// the panel `slot` of a group.
  void solve(Symmetric a, Index begin, const double* roots, Index slot) {
    const Index end = begin + kPanel;
    double* const panel = a.row(begin);
    take_diagonal(panel + begin, a.stride);
    for (Index c = end; c < a.n; c += kTileColumns) {
      double* const tile = columns_.data() + slot * stride_ + c * kPanel;
      for (Index k = 0; k < kPanel; ++k)
        copy(panel + k * a.stride + c, tile + k * kTileColumns);
      solve(tile, roots);
      double* const rows = rows_.data() + slot * stride_ + c * kPanel;
      for (Index k = 0; k < kPanel; ++k) {
        copy(tile + k * kTileColumns, panel + k * a.stride + c);
        for (Index r = 0; r < kTileColumns; ++r)
          rows[r * kPanel + k] = tile[k * kTileColumns + r];
      }
    }
  }

  /// A -= L L^T on rows [first, last) for the panels [from, to) of the group,
  /// one after the other.
  void subtract(
      Symmetric a, Index first, Index last, Index from, Index to) const {
    for (Index begin = first; begin < a.n; begin += kColumnBlock) {
      const Index end = std::min(begin + kColumnBlock, a.n);
      for (Index r = first; r < std::min(last, end); r += kTileRows)
        for (Index c = std::max(begin, r / kTileColumns * kTileColumns);
             c < end;
             c += kTileColumns)
          for (Index slot = from; slot < to; ++slot)
            subtract_tile(
                a, r, c, std::min<Index>(kTileRows, last - r), slot * stride_);
    }
  }

 private:
  /// Rows at once of a solve: their accumulators fit into registers.
  static constexpr Index kSolveRows = kVectorBytes == 64 ? 4 : 2;

  static void copy(const double* from, double* to) {
    store(to, load(from));
    store(to + kWidth, load(from + kWidth));
  }

  /// -L(k, j) of kSolveRows rows k side by side, for each j.
  void take_diagonal(const double* block, Index stride) {
    for (Index k = 0; k < kPanel; ++k) {
      const Index first = k / kSolveRows * kSolveRows;
      double* const to = diagonal_.data() + first * kPanel + k - first;
      for (Index j = 0; j < k; ++j) to[j * kSolveRows] = -block[j * stride + k];
    }
  }

  /// kPanel x kTileColumns numbers of A become those of L.
  void solve(double* tile, const double* roots) const {
    for (Index first = 0; first < kPanel; first += kSolveRows) {
      const double* const s = diagonal_.data() + first * kPanel;
      Pack8 x[kSolveRows], y[kSolveRows];
#pragma GCC unroll 4
      for (Index i = 0; i < kSolveRows; ++i) {
        x[i] = load(tile + (first + i) * kTileColumns);
        y[i] = load(tile + (first + i) * kTileColumns + kWidth);
      }
      for (Index j = 0; j < first; ++j) {
        const Pack8 u = load(tile + j * kTileColumns),
                    v = load(tile + j * kTileColumns + kWidth);
#pragma GCC unroll 4
        for (Index i = 0; i < kSolveRows; ++i) {
          const Pack8 by = broadcast(s[j * kSolveRows + i]);
          x[i] = fma_lanes(by, u, x[i]);
          y[i] = fma_lanes(by, v, y[i]);
        }
      }
#pragma GCC unroll 4
      for (Index i = 0; i < kSolveRows; ++i) {
#pragma GCC unroll 4
        for (Index j = 0; j < i; ++j) {
          const Pack8 by = broadcast(s[(first + j) * kSolveRows + i]);
          x[i] = fma_lanes(by, x[j], x[i]);
          y[i] = fma_lanes(by, y[j], y[i]);
        }
        const Pack8 root = broadcast(roots[first + i]);
        x[i] = x[i] / root, y[i] = y[i] / root;
        store(tile + (first + i) * kTileColumns, x[i]);
        store(tile + (first + i) * kTileColumns + kWidth, y[i]);
      }
    }
  }

  void subtract_tile(
      Symmetric a, Index r, Index c, Index rows, Index slot) const {
    tile_rows(rows,
              kPanel,
              {rows_.data() + slot + r * kPanel, kPanel, 1},
              columns_.data() + slot + c * kPanel,
              kTileColumns,
              [&](Index i, Pack8 x, Pack8 y) {
                double* const to = a.row(r + i) + c;
                store(to, load(to) - x);
                store(to + kWidth, load(to + kWidth) - y);
              });
  }

  Index stride_;  ///< numbers of a panel
  std::vector<double> rows_, columns_;
  std::array<double, kPanel * kPanel> diagonal_;
};

}  // namespace

bool cholesky(Symmetric a) {
  Panels panels(a.n);
  std::array<double, kPanel> roots;
  for (Index begin = 0; begin < a.n;) {
    const Index group_end = std::min(begin + kGroup * kPanel, a.n);
    Index slot = 0;
    for (; begin < group_end; begin += kPanel, ++slot) {
      const Index end = std::min(begin + kPanel, a.n);
      if (!factor_diagonal(a, begin, end, roots.data())) return false;
      if (end == a.n) return true;
      panels.solve(a, begin, roots.data(), slot);
      panels.subtract(a, end, group_end, slot, slot + 1);
    }
    panels.subtract(a, group_end, a.n, 0, slot);
  }
  return true;
}

void cholesky_solve(Symmetric factor, double* b, double* x) {
  const Index n = factor.n;
  for (Index k = 0; k < n; ++k) {  // L y = b
    const double* const row = factor.row(k);
    x[k] = b[k] / row[k];
    axpy(n - k - 1, -x[k], row + k + 1, b + k + 1);
  }
  for (Index k = n; k-- > 0;) {  // L^T x = y
    const double* const row = factor.row(k);
    x[k] = (x[k] - dot(n - k - 1, row + k + 1, x + k + 1)) / row[k];
  }
}

}  // namespace physinv::linalg
