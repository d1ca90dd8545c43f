#include "suite/linalg/bidiagonal_spectrum.h"

#include <algorithm>
#include <cmath>

#include "suite/core/math.h"
#include "suite/linalg/householder.h"

namespace physinv::linalg {
namespace {

/// Registers that search at the same time: their divisions overlap.
constexpr int kGroup = 4;
constexpr Index kLanes = kGroup * kWidth;
constexpr int kTwin = 2;  ///< registers of a Rayleigh quotient
/// Stands for a pivot of zero; its quotients neither overflow nor vanish.
constexpr double kTiny = 1e-140;
constexpr int kRounds = 64, kRefinements = 8;
/// Cosine between two vectors, and residual over value, that are put up with.
constexpr double kCosine = 1e-11, kResidual = 1e-12;

inline Pack8 guarded(const Pack8& pivot) {
  return select(abs_lanes(pivot) < broadcast(kTiny), broadcast(-kTiny), pivot);
}

}  // namespace

/// counts[l] = values of L^T L above x[l], for `groups` times kLanes numbers.
void BidiagonalSpectrum::count_above(const double* x,
                                     double* counts,
                                     Index groups) const {
  for (Index g = 0; g < groups; ++g, x += kLanes, counts += kLanes) {
    Pack8 at[kGroup], s[kGroup], above[kGroup];
#pragma GCC unroll 4
    for (int r = 0; r < kGroup; ++r) {
      at[r] = load(x + r * kWidth);
      s[r] = -at[r];
      above[r] = Pack8{};
    }
    for (Index i = 0; i < n_; ++i) {
      const Pack8 q = broadcast(q_[i]), e = broadcast(e_[i]);
#pragma GCC unroll 4
      for (int r = 0; r < kGroup; ++r) {
        const Pack8 pivot = guarded(s[r] + q);
        above[r] += select(pivot > Pack8{}, broadcast(1), Pack8{});
        s[r] = fma_lanes(e, s[r] / pivot, -at[r]);
      }
    }
#pragma GCC unroll 4
    for (int r = 0; r < kGroup; ++r) store(counts + r * kWidth, above[r]);
  }
}

/// Brackets (low, high] with one value each, in geometric steps first.
void BidiagonalSpectrum::isolate(double floor2, double top) {
  const Index lanes = groups_ * kLanes;
  double* const x = residual_;
  double* const counts = x + lanes;
  // A first look with shifts spread over all decades.
  const double ratio = math::log(floor2 / top);
  for (Index l = 0; l < lanes; ++l)
    x[l] = l + 1 == lanes ? floor2
                          : top * math::exp(ratio * static_cast<double>(l + 1) /
                                            static_cast<double>(lanes));
  count_above(x, counts, groups_);
  count_ = static_cast<Index>(counts[lanes - 1]);
  Index at = 0;
  for (Index j = 0; j < lanes; ++j) {
    const auto rank = static_cast<double>(std::min(j, count_ - 1)) + 1;
    while (at + 1 < lanes && counts[at] < rank) ++at;
    low_[j] = x[at], high_[j] = at == 0 ? top : x[at - 1];
  }
  groups_ = (count_ + kLanes - 1) / kLanes;
  const Index active = groups_ * kLanes;
  for (int round = 0; round < kRounds; ++round) {
    // Far enough apart, Rayleigh quotients find the rest of the way.
    bool alone = true;
    for (Index j = 0; alone && j < count_; ++j) {
      const double width = high_[j] - low_[j];
      double gap = low_[j];
      if (j > 0) gap = std::min(gap, low_[j - 1] - high_[j]);
      if (j + 1 < count_) gap = std::min(gap, low_[j] - high_[j + 1]);
      alone = width <= std::max(0.25 * gap, 1e-10 * low_[j]);
    }
    if (alone) break;
    for (Index j = 0; j < active; j += kWidth) {
      const Pack8 lo = load(low_ + j), hi = load(high_ + j);
      const Pack8 middle =
          select(hi > 4 * lo, sqrt_lanes(lo) * sqrt_lanes(hi), 0.5 * (lo + hi));
      store(x + j, middle);
    }
    count_above(x, counts, groups_);
    for (Index j = 0; j < active; j += kWidth) {
      double rank[kWidth];
      for (Index l = 0; l < kWidth; ++l)
        rank[l] = static_cast<double>(std::min(j + l, count_ - 1)) + 1;
      const auto inside = load(counts + j) >= load(rank);
      const Pack8 middle = load(x + j);
      store(low_ + j, select(inside, middle, load(low_ + j)));
      store(high_ + j, select(inside, load(high_ + j), middle));
    }
  }
}

/// kTwin registers of lanes, so that their divisions overlap, and what is kept
/// of them for each row.
struct BidiagonalSpectrum::Twins {
  static constexpr Index kStep = kTwin * kWidth;
  Twins(double* memory, Index rows)
      : down(memory),
        up(down + rows * kStep),
        s_of(up + rows * kStep),
        z(s_of + rows * kStep) {}

  static Pack8 index(Index i) { return broadcast(static_cast<double>(i)); }

  double *down, *up;  ///< multipliers of the factorisations from both ends
  double* s_of;       ///< what the one from the top leaves of the pivots
  double* z;          ///< vectors
  Pack8 x[kTwin], low[kTwin], high[kTwin], close[kTwin];
  Pack8 length2[kTwin], twist[kTwin], gamma[kTwin];
};

inline void BidiagonalSpectrum::bracket(Twins& t, Index lane) const {
#pragma GCC unroll 2
  for (int r = 0; r < kTwin; ++r) {
    t.low[r] = load(low_ + lane + r * kWidth);
    t.high[r] = load(high_ + lane + r * kWidth);
    t.x[r] = 0.5 * (t.low[r] + t.high[r]);
    // Cubic convergence: the next error is far below rounding.
    t.close[r] = fma_lanes(
        broadcast(1e-6), t.high[r] - t.low[r], broadcast(1e-11) * t.low[r]);
  }
}

inline void BidiagonalSpectrum::factor_down(Twins& t) const {
  Pack8 s[kTwin];
#pragma GCC unroll 2
  for (int r = 0; r < kTwin; ++r) s[r] = -t.x[r];
  for (Index i = 0; i < n_; ++i) {
#pragma GCC unroll 2
    for (int r = 0; r < kTwin; ++r) {
      store(t.s_of + i * t.kStep + r * kWidth, s[r]);
      const Pack8 inverse = 1 / guarded(q_[i] + s[r]);
      store(t.down + i * t.kStep + r * kWidth, off_[i] * inverse);
      s[r] = fma_lanes(e_[i] * s[r], inverse, -t.x[r]);
    }
  }
}

/// The twist is where gamma is smallest.
inline void BidiagonalSpectrum::factor_up(Twins& t) const {
  Pack8 p[kTwin];
#pragma GCC unroll 2
  for (int r = 0; r < kTwin; ++r) {
    p[r] = q_[n_ - 1] - t.x[r];
    t.gamma[r] = load(t.s_of + (n_ - 1) * t.kStep + r * kWidth) + p[r] + t.x[r];
    t.twist[r] = t.index(n_ - 1);
  }
  for (Index i = n_ - 2; i >= 0; --i) {
#pragma GCC unroll 2
    for (int r = 0; r < kTwin; ++r) {
      const Pack8 inverse = 1 / guarded(e_[i] + p[r]);
      store(t.up + i * t.kStep + r * kWidth, off_[i] * inverse);
      p[r] = fma_lanes(q_[i] * p[r], inverse, -t.x[r]);
      const Pack8 here =
          load(t.s_of + i * t.kStep + r * kWidth) + p[r] + t.x[r];
      const auto smaller = abs_lanes(here) < abs_lanes(t.gamma[r]);
      t.gamma[r] = select(smaller, here, t.gamma[r]);
      t.twist[r] = select(smaller, t.index(i), t.twist[r]);
    }
  }
}

/// The vector from its twist, where it is 1, to the top.
inline void BidiagonalSpectrum::solve_up(Twins& t) const {
  Pack8 entry[kTwin];
#pragma GCC unroll 2
  for (int r = 0; r < kTwin; ++r) entry[r] = t.length2[r] = Pack8{};
  for (Index i = n_ - 1; i >= 0; --i) {
    const Pack8 here = t.index(i);
#pragma GCC unroll 2
    for (int r = 0; r < kTwin; ++r) {
      const Pack8 next = -load(t.down + i * t.kStep + r * kWidth) * entry[r];
      entry[r] = select(here == t.twist[r],
                        broadcast(1),
                        select(here < t.twist[r], next, Pack8{}));
      store(t.z + i * t.kStep + r * kWidth, entry[r]);
      t.length2[r] = fma_lanes(entry[r], entry[r], t.length2[r]);
    }
  }
}

/// And to the bottom.
inline void BidiagonalSpectrum::solve_down(Twins& t) const {
  Pack8 entry[kTwin];
#pragma GCC unroll 2
  for (int r = 0; r < kTwin; ++r) entry[r] = load(t.z + r * kWidth);
  for (Index i = 1; i < n_; ++i) {
    const Pack8 here = t.index(i);
#pragma GCC unroll 2
    for (int r = 0; r < kTwin; ++r) {
      const auto below = here > t.twist[r];
      const Pack8 next =
          -load(t.up + (i - 1) * t.kStep + r * kWidth) * entry[r];
      entry[r] = select(below, next, load(t.z + i * t.kStep + r * kWidth));
      t.length2[r] += select(below, entry[r] * entry[r], Pack8{});
      store(t.z + i * t.kStep + r * kWidth, entry[r]);
    }
  }
}

void BidiagonalSpectrum::keep(const Twins& t, Index lane) {
  for (Index j = lane; j < std::min(lane + t.kStep, count_); ++j) {
    const Index r = (j - lane) / kWidth, l = (j - lane) % kWidth;
    const double scale = 1 / std::sqrt(t.length2[r][l]);
    lambda_(j) = t.x[r][l];
    residual_[j] = std::abs(t.gamma[r][l]) * scale / t.x[r][l];
    double* const to = v_.col(j).data();
    for (Index i = 0; i < n_; ++i) to[i] = t.z[i * t.kStep + j - lane] * scale;
    first_(j) = to[n_ - 1];
  }
}

/// Values and vectors of the lanes from `lane` on, by Rayleigh quotients.
void BidiagonalSpectrum::refine(Index lane) {
  Twins t(static_cast<double*>(vectors_.data()), n_);
  bracket(t, lane);
  bool last = false;
  for (int round = 0; round < kRefinements; ++round) {
    factor_down(t);
    factor_up(t);
    solve_up(t);
    solve_down(t);
    if (last) break;
    last = true;
#pragma GCC unroll 2
    for (int r = 0; r < kTwin; ++r) {
      const Pack8 low = t.low[r], high = t.high[r];
      Pack8 next = t.x[r] + t.gamma[r] / t.length2[r];
      next = select(next < low, low, select(next > high, high, next));
      last = last && !any(abs_lanes(next - t.x[r]) > t.close[r]);
      t.x[r] = next;
    }
  }
  keep(t, lane);
}

bool BidiagonalSpectrum::orthogonal() {
  for (Index j = 0; j < count_; ++j) {
    if (!(residual_[j] <= kResidual)) return false;
    for (Index i = 0; i < j; ++i)
      if (!(std::abs(dot(v_.rows(), v_.col(i).data(), v_.col(j).data())) <=
            kCosine))
        return false;
  }
  return true;
}

bool BidiagonalSpectrum::find(VectorIn<double> a,
                              VectorIn<double> b,
                              double floor) {
  n_ = a.size();
  groups_ = (n_ + kLanes - 1) / kLanes;
  const Index lanes = groups_ * kLanes, padded = round_up(n_, kWidth);
  const auto reserve = [](Buffer& buffer, Index count) {
    return static_cast<double*>(
        buffer.reserve(static_cast<std::size_t>(count) * sizeof(double)));
  };
  q_ = reserve(memory_, 3 * padded + 4 * lanes);
  e_ = q_ + padded, off_ = e_ + padded;
  low_ = off_ + padded, high_ = low_ + lanes, residual_ = high_ + lanes;
  reserve(vectors_, 4 * n_ * kTwin * kWidth);
  double top = 0;
  for (Index i = 0; i < n_; ++i) {
    const double diagonal = a(n_ - 1 - i);
    const double beside = i + 1 < n_ ? b(n_ - 2 - i) : 0;
    q_[i] = diagonal * diagonal;
    e_[i] = beside * beside;
    off_[i] = diagonal * beside;
    const double before = i > 0 ? std::abs(b(n_ - 1 - i)) : 0;
    top =
        std::max(top, std::abs(diagonal) + std::max(before, std::abs(beside)));
  }
  count_ = 0;
  // Singular values are at most the largest row or column of [0 L; L^T 0].
  top *= 1 + 1e-10;
  if (!(floor < top)) return true;
  isolate(floor * floor, top * top);
  if (lambda_.size() < n_) lambda_.resize(n_), first_.resize(n_);
  if (v_.rows() != padded || v_.cols() < count_) v_.setZero(padded, n_);
  for (Index lane = 0; lane < count_; lane += kTwin * kWidth) refine(lane);
  return orthogonal();
}

void BidiagonalSpectrum::combine(VectorIn<double> w,
                                 VectorOut<double> out) const {
  out.setZero();
  for (Index j = 0; j < w.size(); ++j) {
    const double* v = v_.col(j).data();
    for (Index i = 0; i < n_; ++i)
      out(n_ - 1 - i) = std::fma(w(j), v[i], out(n_ - 1 - i));
  }
}

}  // namespace physinv::linalg
