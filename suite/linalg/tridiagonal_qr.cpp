#include "suite/linalg/tridiagonal_qr.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "suite/core/math.h"
#include "suite/linalg/sweep_lanes.h"

namespace physinv::linalg {
namespace {

constexpr Index kSweepsPerRow = 60;
/// Shorter blocks run sweep by sweep, as does a block that this many rounds
/// have not shortened.
constexpr Index kLongBlock = 4 * kSweeps;
constexpr Index kPatience = 30;
/// e counts as zero in the search for shifts: its square is their error.
constexpr double kShiftTolerance = 1e-8;

/// The eigenvalue of the last 2 x 2 block that is nearer to its last entry.
double wilkinson(double a, double b, double off) {
  const double half = 0.5 * (a - b);
  if (off == 0) return b;
  const double ratio = half / off;
  const double root = math::hypot(ratio, 1.0);
  return b - off / (ratio + std::copysign(root, ratio));
}

// The recurrence of LAPACK's dsteqr: one square root and one division on the
// path from rotation to rotation. turn(i, c, s) gets the plane (i, i + 1).
template <class Turn>
void sweep(double* d, double* e, Index start, Index end, Turn&& turn) {
  double g = d[start] - wilkinson(d[end - 1], d[end], e[end - 1]);
  double c = 1, s = 1, p = 0, r;
  for (Index i = start; i < end; ++i) {
    const double f = s * e[i], b = c * e[i];
    rotation(g, f, c, s, r);
    if (i > start) e[i - 1] = r;
    g = d[i] - p;
    r = (d[i + 1] - g) * s + 2 * c * b;
    p = s * r;
    d[i] = g + p;
    g = c * r - b;
    turn(i, c, s);
  }
  d[end] -= p;
  e[end - 1] = g;
}

/// reduce(start, end) for the last block until all e are zero or it is false.
template <class Reduce>
bool deflate(double* d, double* e, Index n, double tolerance, Reduce&& reduce) {
  const auto negligible = [&](Index i) {
    return std::abs(e[i]) <= tolerance * (std::abs(d[i]) + std::abs(d[i + 1]));
  };
  for (Index end = n - 1; end > 0;) {
    if (negligible(end - 1)) {
      e[--end] = 0;
      continue;
    }
    Index start = end - 1;
    while (start > 0 && !negligible(start - 1)) --start;
    if (start > 0) e[start - 1] = 0;
    if (!reduce(start, end)) return false;
  }
  return true;
}

/// The eigenvalues of the last kSweeps rows.
bool find_shifts(const double* d, const double* e, Index end, double* shifts) {
  double off[kSweeps - 1];
  std::copy_n(d + end - kSweeps + 1, kSweeps, shifts);
  std::copy_n(e + end - kSweeps + 1, kSweeps - 1, off);
  Index left = kSweepsPerRow * kSweeps;
  const auto reduce = [&](Index start, Index last) {
    sweep(shifts, off, start, last, [](Index, double, double) {});
    return --left > 0;
  };
  return deflate(shifts, off, kSweeps, kShiftTolerance, reduce);
}

/// x <- the rotations of one sweep backwards; `record` is their end.
template <class X>
void turn_back(X* x, Index start, Index end, const double* record) {
  X carried = x[end];
  for (Index i = end - 1; i >= start; --i) {
    const double s = *--record, c = *--record;
    const X low = x[i];
    x[i + 1] = s * low + c * carried;
    carried = c * low - s * carried;
  }
  x[start] = carried;
}

}  // namespace

std::size_t TridiagonalQr::Round::numbers() const {
  const Index steps = end - start + (sweeps == 1 ? 0 : kLag + 1);
  return static_cast<std::size_t>(2 * sweeps * steps);
}

double* TridiagonalQr::begin(const Round& round) {
  const std::size_t base = used_;
  used_ += round.numbers();
  // Not doubled: this is the larger part of the memory.
  if (record_.capacity() < used_) record_.reserve(used_ + used_ / 2);
  if (record_.size() < used_) record_.resize(used_);
  rounds_.push_back(round);
  rotations_ += round.sweeps * (round.end - round.start);
  sweeps_ += round.sweeps;
  return record_.data() + base;
}

void TridiagonalQr::single(
    double* d, double* e, double* x, Index start, Index end) {
  double* record = begin({start, end, 1});
  double head = x[start];
  sweep(d, e, start, end, [&](Index i, double c, double s) {
    const double next = x[i + 1];
    x[i] = s * next + c * head;
    head = c * next - s * head;
    *record++ = c, *record++ = s;
  });
  x[end] = head;
}

bool TridiagonalQr::several(
    double* d, double* e, double* x, Index start, Index end) {
  double shifts[kSweeps];
  if (!find_shifts(d, e, end, shifts)) return false;
  Chains chains{};
  for (int k = 0; k < kChains; ++k)
    chains[k].shift = physinv::load<Four>(shifts + 4 * k);
  chains[0].row[0] = d[start], chains[0].head[0] = x[start];

  const Index count = end - start;
  double* record = begin({start, end, kSweeps});
  for (Index t = 0; t <= count + kLag; ++t, record += 2 * kSweeps)
    if (t > kLag && t < count) [[likely]]
      step<false>(chains, d, e, x, start, end, t, record);
    else
      step<true>(chains, d, e, x, start, end, t, record);
  return true;
}

bool TridiagonalQr::run(VectorOut<double> d,
                        VectorOut<double> e,
                        VectorOut<double> x) {
  rounds_.clear();
  used_ = 0, rotations_ = 0, sweeps_ = 0;
  const Index n = d.size(), limit = kSweepsPerRow * n;
  // Enough for the Gram matrices of ill-conditioned problems.
  record_.reserve(static_cast<std::size_t>(n * n + n * n / 4));
  Index rows = 0, tries = 0;
  return deflate(
      d.data(),
      e.data(),
      n,
      std::numeric_limits<double>::epsilon(),
      [&](Index start, Index end) {
        if (sweeps_ >= limit) return false;
        if (end - start != rows) rows = end - start, tries = 0;
        const bool many =
            rows >= kLongBlock && tries++ < kPatience && 2 * sweeps_ < limit;
        if (!many || !several(d.data(), e.data(), x.data(), start, end))
          single(d.data(), e.data(), x.data(), start, end);
        return true;
      });
}

template <class X>
void TridiagonalQr::apply(X* x, Index first) const {
  const double* record = record_.data() + used_;
  for (auto round = rounds_.rbegin(); round != rounds_.rend();
       record -= round->numbers(), ++round) {
    if (round->end < first) continue;
    first = std::min(first, round->start);
    if (round->sweeps == 1) {
      turn_back(x, round->start, round->end, record);
    } else {
      turn_back_all(x, round->start, round->end, record);
    }
  }
}

template void TridiagonalQr::apply(double*, Index) const;
template void TridiagonalQr::apply(Pack8*, Index) const;

}  // namespace physinv::linalg
