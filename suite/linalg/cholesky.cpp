#include "suite/linalg/cholesky.h"

#include <algorithm>
#include <cmath>

#include "suite/linalg/householder.h"
#include "suite/linalg/tile_product.h"

namespace physinv::linalg {
namespace {

/// Columns at once: a tile of theirs stays in the L1. A multiple of a tile.
constexpr Index kPanel = 64;

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

/// Columns [begin, end) of L from what earlier panels left of A.
bool factor_panel(Symmetric a, Index begin, Index end) {
  for (Index k = begin; k < end; ++k) {
    double* const row = a.row(k);
    Index j = begin;
    for (; j + 4 <= k; j += 4)
      subtract<4>(k, a.n, a.row(j) + k, a.stride, a.row(j), a.stride, row);
    for (; j < k; ++j)
      subtract<1>(k, a.n, a.row(j) + k, a.stride, a.row(j), a.stride, row);
    if (!(row[k] > 0)) return false;
    const Pack8 root = broadcast(std::sqrt(row[k]));
    for (Index c = k / kWidth * kWidth; c < a.n; c += kWidth)
      store(row + c, load(row + c) / root);
  }
  return true;
}

/// A -= L L^T on rows and columns from `end` on, for columns [begin, end) of L.
void subtract_panel(Symmetric a, Index begin, Index end) {
  const double* const panel = a.row(begin);
  for (Index j = end; j < a.n; j += kTileColumns)
    tile_rows(std::min(j + kTileColumns, a.n) - end,
              end - begin,
              {panel + end, 1, a.stride},
              panel + j,
              a.stride,
              [&](Index r, Pack8 x, Pack8 y) {
                double* const to = a.row(end + r) + j;
                store(to, load(to) - x);
                store(to + kWidth, load(to + kWidth) - y);
              });
}

}  // namespace

bool cholesky(Symmetric a) {
  for (Index begin = 0; begin < a.n; begin += kPanel) {
    const Index end = std::min(begin + kPanel, a.n);
    if (!factor_panel(a, begin, end)) return false;
    subtract_panel(a, begin, end);
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
