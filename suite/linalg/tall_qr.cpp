#include "suite/linalg/tall_qr.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "suite/core/check.h"
#include "suite/core/simd/finite.h"
#include "suite/linalg/householder.h"

namespace physinv::linalg {
namespace {

constexpr int kPanel = 4;

/// Reflectors I - V S V^T of one panel; the columns of V lie in the matrix.
struct Panel {
  const double* v[kPanel];
  double s[kPanel][kPanel];  ///< upper triangular
};

/// Columns whose products with a panel stay in registers.
#ifdef __aarch64__
constexpr int kProjected = 1;
#else
constexpr int kProjected = 2;
#endif

/// w[k][c] = V_k y_c by lanes, for columns c from kFirst on.
template <int kFirst, int N>
[[gnu::always_inline]] inline void project_columns(const Panel& p,
                                                   double* const* y,
                                                   Index begin,
                                                   Index end,
                                                   Pack8 (&w)[kPanel][N]) {
  constexpr int kLast = kFirst + kProjected < N ? kFirst + kProjected : N;
  for (Index i = begin; i < end; i += kWidth) {
    Pack8 at[N];
#pragma GCC unroll 4
    for (int c = kFirst; c < kLast; ++c) at[c] = held(load(y[c] + i));
#pragma GCC unroll 8
    for (int k = 0; k < kPanel; ++k) {
      const Pack8 v = held(load(p.v[k] + i));
#pragma GCC unroll 4
      for (int c = kFirst; c < kLast; ++c)
        w[k][c] = fma_lanes(v, at[c], w[k][c]);
    }
  }
  if constexpr (kLast < N) project_columns<kLast>(p, y, begin, end, w);
}

/// N columns y <- (I - V S V^T)^T y on rows [begin, end), multiples of kWidth.
template <int N>
void reflect_columns(const Panel& p, double* const* y, Index begin, Index end) {
  Pack8 w[kPanel][N];
#pragma GCC unroll 8
  for (int k = 0; k < kPanel; ++k)
#pragma GCC unroll 4
    for (int c = 0; c < N; ++c) w[k][c] = Pack8{};
  project_columns<0>(p, y, begin, end, w);
  Pack8 f[kPanel][N];
#pragma GCC unroll 4
  for (int c = 0; c < N; ++c) {
    double along[kPanel];
#pragma GCC unroll 8
    for (int k = 0; k < kPanel; ++k) along[k] = sum_of(w[k][c]);
#pragma GCC unroll 8
    for (int k = 0; k < kPanel; ++k) {
      double total = 0;
      for (int l = 0; l <= k; ++l) total = std::fma(p.s[l][k], along[l], total);
      f[k][c] = broadcast(-total);
    }
  }
  for (Index i = begin; i < end; i += kWidth) {
    Pack8 at[N];
#pragma GCC unroll 4
    for (int c = 0; c < N; ++c) at[c] = load(y[c] + i);
#pragma GCC unroll 8
    for (int k = 0; k < kPanel; ++k) {
      const Pack8 v = held(load(p.v[k] + i));
#pragma GCC unroll 4
      for (int c = 0; c < N; ++c) at[c] = fma_lanes(v, f[k][c], at[c]);
    }
#pragma GCC unroll 4
    for (int c = 0; c < N; ++c) store(y[c] + i, at[c]);
  }
}

}  // namespace

void TallColumns::open(Index rows, Index columns) {
  rows_ = rows, columns_ = columns;
  // A column of zeros behind the last fills the last panel.
  stride_ = round_up(rows, kWidth) + kWidth;
  data_ = static_cast<double*>(memory_.reserve(
      static_cast<std::size_t>(stride_ * (columns + 1)) * sizeof(double)));
  for (Index j = 0; j < columns; ++j)
    std::fill(column(j) + rows, column(j) + stride_, 0.0);
  std::fill(column(columns), column(columns) + stride_, 0.0);
}

bool TallColumns::finite() const {
  for (Index j = 0; j < columns_; ++j)
    if (!all_finite(column(j), rows_)) return false;
  return true;
}

namespace {

/// Reflectors of columns first .. first+count-1, on rows [begin, end); what is
/// above their heads moves to R.
void factor_panel(TallColumns& a,
                  Index first,
                  int count,
                  Index begin,
                  Index end,
                  BatchOut<double>& r,
                  Panel& p,
                  double* tau) {
  for (int k = 0; k < count; ++k) {
    const Index at = first + k;
    double* x = a.column(at);
    // What is above the head belongs to R already; V has zeros there.
    for (Index i = 0; i < at; ++i) {
      r(i, at) = x[i];
      x[i] = 0;
    }
    tau[k] = reflect(a.rows() - at, x + at, r(at, at));
    p.v[k] = x;
    if (tau[k] == 0) x[at] = 0;
    for (int c = k + 1; c < count; ++c) {
      double* y = a.column(first + c);
      axpy(end - begin,
           -tau[k] * dot(end - begin, x + begin, y + begin),
           x + begin,
           y + begin);
    }
  }
}

/// S of the panel.
void form_factor(
    int count, Index begin, Index end, const double* tau, Panel& p) {
  for (int k = 0; k < count; ++k) {
    p.s[k][k] = tau[k];
    double inner[kPanel];
    for (int l = 0; l < k; ++l)
      inner[l] = dot(end - begin, p.v[l] + begin, p.v[k] + begin);
    for (int l = 0; l < k; ++l) {
      double total = 0;
      for (int m = l; m < k; ++m) total = std::fma(p.s[l][m], inner[m], total);
      p.s[l][k] = -tau[k] * total;
    }
  }
}

}  // namespace

void triangularize(TallColumns& a, Index pivots, BatchOut<double> r) {
  const Index rows = a.rows(), columns = a.columns();
  SUITE_CHECK(rows >= pivots && columns >= pivots && r.rows() == pivots &&
                  r.cols() == columns,
              "the matrix must have at least as many rows as columns and the "
              "result its size");
  const Index end = round_up(rows, kWidth);
  if (!a.finite()) {
    r.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  r.setZero();
  for (Index first = 0; first < pivots; first += kPanel) {
    const int count = static_cast<int>(std::min<Index>(kPanel, pivots - first));
    const Index begin = first / kWidth * kWidth;
    Panel p{};
    for (int k = 0; k < kPanel; ++k) p.v[k] = a.column(columns);
    double tau[kPanel] = {};
    factor_panel(a, first, count, begin, end, r, p, tau);
    form_factor(count, begin, end, tau, p);
    Index j = first + count;
    for (; j + 2 <= columns; j += 2) {
      double* const y[] = {a.column(j), a.column(j + 1)};
      reflect_columns<2>(p, y, begin, end);
    }
    for (; j < columns; ++j) {
      double* const y[] = {a.column(j)};
      reflect_columns<1>(p, y, begin, end);
    }
  }
  for (Index j = pivots; j < columns; ++j)
    for (Index i = 0; i < pivots; ++i) r(i, j) = a.column(j)[i];
}

}  // namespace physinv::linalg
