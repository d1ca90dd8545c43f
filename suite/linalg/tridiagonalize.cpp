#include "suite/linalg/tridiagonalize.h"

#include <algorithm>
#include <cmath>

#include "suite/core/blocks.h"
#include "suite/linalg/householder.h"
#include "suite/linalg/panel_parts.h"

namespace physinv::linalg {
namespace {

constexpr Index kPanel = 12;  ///< columns of a panel of the one-stage form
constexpr Index kTwoStagesFrom = 1024;
constexpr Index kRows = 64;  ///< of a panel, for a thread at once

// Products with a thin panel: the `count` memory rows X_k, `stride` numbers
// apart, several of them in one pass over the other vector. Lengths are
// rounded up to whole registers, so rows and vectors are padded.

/// Rows whose products with one vector stay in registers.
#ifdef __aarch64__
constexpr int kDots = 4;
#else
constexpr int kDots = kParts == 1 ? 8 : 6;
#endif

/// f.operator()<kRows>(k) for groups of kMost, 2 and 1 rows that cover `count`.
template <int kMost, class F>
void for_row_groups(Index count, F&& f) {
  Index k = 0;
  for (; k + kMost <= count; k += kMost) f.template operator()<kMost>(k);
  for (; k + 2 <= count; k += 2) f.template operator()<2>(k);
  if (k < count) f.template operator()<1>(k);
}

/// y -= sum_k s_k X_k and z -= sum_k t_k X_k.
void subtract_combinations(Index n,
                           Index count,
                           const double* s,
                           const double* t,
                           const double* x,
                           Index stride,
                           double* y,
                           double* z) {
  for_row_groups<4>(count, [&]<int kRows>(Index k) {
    const double* const from = x + k * stride;
    Pack8 by_s[kRows], by_t[kRows];
#pragma GCC unroll 4
    for (int i = 0; i < kRows; ++i)
      by_s[i] = broadcast(-s[k + i]), by_t[i] = broadcast(-t[k + i]);
    for (Index c = 0; c < n; c += kWidth) {
      Pack8 to_y = load(y + c), to_z = load(z + c);
#pragma GCC unroll 4
      for (int i = 0; i < kRows; ++i) {
        const Pack8 v = held(load(from + i * stride + c));
        to_y = fma_lanes(by_s[i], v, to_y);
        to_z = fma_lanes(by_t[i], v, to_z);
      }
      store(y + c, to_y), store(z + c, to_z);
    }
  });
}

/// s_k = X_k.v.
void project(Index n,
             Index count,
             const double* x,
             Index stride,
             const double* v,
             double* s) {
  for_row_groups<kDots>(count, [&]<int kRows>(Index k) {
    const double* const from = x + k * stride;
    Pack8 dots[kRows] = {};
    for (Index c = 0; c < n; c += kWidth) {
      const Pack8 vc = held(load(v + c));
#pragma GCC unroll 8
      for (int i = 0; i < kRows; ++i)
        dots[i] = fma_lanes(load(from + i * stride + c), vc, dots[i]);
    }
#pragma GCC unroll 8
    for (int i = 0; i < kRows; ++i) s[k + i] = sum_of(dots[i]);
  });
}

double* reserve(Buffer& buffer, Index count) {
  return static_cast<double*>(
      buffer.reserve(static_cast<std::size_t>(count) * sizeof(double)));
}
double* data(const Buffer& buffer) {
  return static_cast<double*>(buffer.data());
}

}  // namespace

Symmetric Tridiagonalize::matrix(Index n) {
  const Index stride = padded_stride(n);
  a_ = {reserve(memory_, n * stride), n, stride};
  // What tiles reach of the scratch in front of the diagonal has to be numbers.
  constexpr Index kReach = kTileColumns + kTileRows;
  for (Index r = 0; r < n; ++r) {
    std::fill(a_.row(r) + std::max<Index>(r - kReach, 0), a_.row(r) + r, 0.0);
    std::fill(a_.row(r) + n, a_.row(r) + stride, 0.0);
  }
  return a_;
}

void Tridiagonalize::reduce(Stages stages) {
  const Index n = a_.n;
  d_.resize(n), e_.resize(std::max<Index>(n - 1, 0)), tau_.setZero(n);
  two_ = stages == Stages::two ||
         (stages == Stages::automatic && n >= kTwoStagesFrom);
  const Index count = std::max(kPanel + 1, kBand);  // one to spare
  for (Buffer* b : {&v_, &w_})
    std::fill_n(reserve(*b, count * a_.stride), count * a_.stride, 0.0);
  two_ ? two_stage() : one_stage();
}

void Tridiagonalize::one_stage() {
  const Index n = a_.n, stride = a_.stride;
  for (Index first = 0; first < n; first += kPanel) {
    const Index count = std::min(kPanel, n - first);
    panel(first, count);
    // Where one core makes the products with vectors, the matrix stays with it.
    const Index behind = first + count;
    Threads* const threads = n - behind < kThreadRows ? nullptr : threads_;
    update_(a_, behind, data(v_), data(w_), stride, count, threads);
  }
}

/// Reflectors of `count` columns; the matrix behind them is left as it was,
/// A - V W^T - W V^T in truth. Products start at whole registers, where v_i
/// and w_i are zero up to row i. V and W are read twice for each column: once
/// for V^T v and W^T v, once for what they take from w and from the next
/// column.
void Tridiagonalize::panel(Index first, Index count) {
  const Index n = a_.n, stride = a_.stride;
  double* const v = data(v_);
  double* const w = data(w_);
  double by_v[kPanel], by_w[kPanel], next_v[kPanel], next_w[kPanel];
  for (Index i = 0; i < count; ++i) {
    const Index j = first + i, k = j + 1, rest = n - k;
    double* const x = a_.row(j);
    double* const vi = v + i * stride;
    double* const wi = w + i * stride;
    d_(j) = x[j];
    if (rest == 0) return;
    const Index from = k / kWidth * kWidth, length = n - from;
    const double tau = tau_(j) = reflect(rest, x + k, e_(j));
    std::fill(vi + from, vi + k, 0.0);
    std::copy(x + k, x + stride, vi + k);
    product_(a_, k, vi, wi, threads_);
    project(length, i, v + from, stride, vi + from, by_v);
    project(length, i, w + from, stride, vi + from, by_w);
    // The column behind the panel is left to RankUpdate: its copy is not read.
    double* const next =
        (i + 1 < count ? a_.row(k) : w + kPanel * stride) + from;
    for (Index p = 0; p < i; ++p) {
      next_v[p] = v[p * stride + k];
      next_w[p] = w[p * stride + k];
    }
    subtract_combinations(
        length, i, by_w, next_w, v + from, stride, wi + from, next);
    subtract_combinations(
        length, i, by_v, next_v, w + from, stride, wi + from, next);
    std::fill(wi + from, wi + k, 0.0);
    for (Index c = k; c < n; ++c) wi[c] *= tau;
    axpy(rest, -0.5 * tau * dot(rest, wi + k, vi + k), vi + k, wi + k);
    std::fill(wi + n, wi + stride, 0.0);
    for (Index c = 0; c < length; ++c)
      next[c] = std::fma(
          -wi[k], vi[from + c], std::fma(-vi[k], wi[from + c], next[c]));
  }
}

/// QR of the block of columns first.. from row `start` on, in place: memory
/// rows hold the reflectors (unit head written out), the band gets R.
void Tridiagonalize::factor_panel(Index first, Index start) {
  const Index n = a_.n, count = std::min(kBand, n - first);
  for (Index i = 0; i < count; ++i) {
    double* x = a_.row(first + i) + start;
    const Index at = std::min(i, n - start - 1);
    const Index length = n - start - at;
    for (Index r = 0; r < at; ++r) band_.entry(start + r, first + i) = x[r];
    std::fill(x, x + at, 0.0);
    double beta = x[at];
    double tau = 0;
    if (length > 1) {
      tau = reflect(length, x + at, beta);
    } else {
      x[at] = 0;
    }
    tau_(first + i) = tau;
    band_.entry(start + at, first + i) = beta;
    if (tau == 0) continue;
    for (Index c = i + 1; c < count; ++c) {
      double* y = a_.row(first + c) + start + at;
      axpy(length, -tau * dot(length, x + at, y), x + at, y);
    }
  }
}

/// S of the product I - V S V^T of a panel's reflectors (kBand x kBand).
void Tridiagonalize::triangular_factor(Index start,
                                       const double* v,
                                       double* s) const {
  constexpr Index b = kBand;
  alignas(64) double inner[b * b] = {};
  multiply<Into::set>(
      b, b, a_.n - start, {v + start * b, 1, b}, v + start * b, b, inner, b);
  const double* const tau = tau_.data() + start - b;
  for (Index k = 0; k < b; ++k) {
    s[k * b + k] = tau[k];
    for (Index i = 0; i < k; ++i) {
      double z = 0;
      for (Index l = i; l < k; ++l)
        z = std::fma(s[i * b + l], inner[l * b + k], z);
      s[i * b + k] = -tau[k] * z;
    }
  }
}

/// A V from one triangle: every square block is used as itself and mirrored.
/// Parts of equal area sum in their own copies, added up in order. If they do
/// not divide among the threads, a thread takes half of the columns of V.
void Tridiagonalize::multiply_panel(Index start, const double* v, double* av) {
  constexpr Index b = kBand, square = PanelParts::kSquare;
  const Index n = a_.n, stride = a_.stride, size = n * b;
  const PanelParts parts(n - start);
  const Index count = parts.count();
  const bool even = count == 1 || count % count_of(threads_) == 0;
  const Index cuts = even ? 1 : 2, width = b / cuts;
  if (static_cast<Index>(parts_.size()) < (count - 1) * size)
    parts_.resize(static_cast<std::size_t>((count - 1) * size));
  for_blocks(threads_, count * cuts, [&](Index task, int) {
    const Index p = task / cuts, column = task % cuts * width;
    const Index begin = start + parts.begin(p),
                end = start + parts.begin(p + 1);
    const double* const x = v + column;
    double* const to = (p == 0 ? av : parts_.data() + (p - 1) * size) + column;
    for (Index r = begin; r < n; ++r) std::fill_n(to + r * b, width, 0.0);
    alignas(64) double block[square * square];
    const auto add =
        [&](Index rows, Index depth, Scalars a, Index from, Index into) {
          multiply<Into::add>(
              rows, width, depth, a, x + from * b, b, to + into * b, b);
        };
    for (Index r = begin; r < end; r += square) {
      const Index rows = std::min(square, n - r);
      for (Index k = 0; k < rows; ++k)
        for (Index l = k; l < rows; ++l)
          block[k * square + l] = block[l * square + k] = a_.row(r + k)[r + l];
      add(rows, rows, {block, square, 1}, r, r);
      for (Index c = r + square; c < n; c += square) {
        const Index columns = std::min(square, n - c);
        const double* from = a_.row(r) + c;
        add(rows, columns, {from, stride, 1}, c, r);
        add(columns, rows, {from, 1, stride}, r, c);
      }
    }
  });
  for (Index p = 1; p < count; ++p) {
    const double* part = parts_.data() + (p - 1) * size;
    for (Index i = (start + parts.begin(p)) * b; i < size; ++i)
      av[i] += part[i];
  }
}

/// A <- Q^T A Q behind `start` with Q = I - V S V^T, the V of the last panel
/// in v_ (memory rows) and in x_ (row-major):
///
///   Y = A V S,  W = Y - V (S^T V^T Y) / 2,  A -= V W^T + W V^T
void Tridiagonalize::update_behind(Index start) {
  constexpr Index b = kBand;
  const Index n = a_.n, stride = a_.stride, rest = n - start;
  const double* const vt = data(v_);
  double* const v = reserve(x_, 4 * n * b);
  double* const av = v + n * b;
  double* const y = av + n * b;
  // f(begin, end) on the rows behind `start`.
  const auto rows = [&](auto&& f) {
    for_blocks(threads_, (rest + kRows - 1) / kRows, [&](Index block, int) {
      const Index begin = start + block * kRows;
      f(begin, std::min(begin + kRows, n));
    });
  };
  rows([&](Index begin, Index end) {
    for (Index c = begin; c < end; ++c)
      for (Index i = 0; i < b; ++i) v[c * b + i] = vt[i * stride + c];
  });
  alignas(64) double s[b * b] = {}, inner[b * b] = {}, half[b * b] = {};
  triangular_factor(start, v, s);
  multiply_panel(start, v, av);
  rows([&](Index begin, Index end) {
    multiply<Into::set>(
        end - begin, b, b, {av + begin * b, b, 1}, s, b, y + begin * b, b);
  });
  multiply<Into::set>(
      b, b, rest, {v + start * b, 1, b}, y + start * b, b, inner, b);
  multiply<Into::set>(b, b, b, {s, 1, b}, inner, b, half, b);
  for (double& h : half) h *= -0.5;
  double* const wt = data(w_);
  rows([&](Index begin, Index end) {
    multiply<Into::add>(
        end - begin, b, b, {v + begin * b, b, 1}, half, b, y + begin * b, b);
    for (Index c = begin; c < end; ++c)
      for (Index i = 0; i < b; ++i) wt[i * stride + c] = y[c * b + i];
  });
  update_(a_, start, vt, wt, stride, b, threads_);
}

void Tridiagonalize::two_stage() {
  const Index n = a_.n, stride = a_.stride;
  band_.reset(n);
  for (Index first = 0; first < n; first += kBand) {
    const Index start = std::min(first + kBand, n);
    for (Index r = first; r < start; ++r)
      for (Index c = r; c < start; ++c) band_.entry(c, r) = a_.row(r)[c];
    if (start == n) break;
    factor_panel(first, start);
    for (Index i = 0; i < kBand; ++i) {
      const double* x = a_.row(first + i);
      std::copy(x + start, x + stride, data(v_) + i * stride + start);
    }
    update_behind(start);
  }
  band_.reduce(d_, e_, threads_);
}

template <class X>
void Tridiagonalize::apply(X* x) const {
  const Index n = a_.n;
  if (two_) band_.apply(x);
  for (Index j = n - 2; j >= 0; --j) {
    const double tau = tau_(j);
    if (tau == 0) continue;
    const Index from = two_ ? j / kBand * kBand + kBand + j % kBand : j + 1;
    if (from >= n) continue;
    turn(n - from, tau, a_.row(j) + from, x + from);
  }
}

template void Tridiagonalize::apply(double*) const;
template void Tridiagonalize::apply(Pack8*) const;

}  // namespace physinv::linalg
