#include "suite/linalg/band.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>

#include "suite/core/blocks.h"
#include "suite/core/waitable_count.h"
#include "suite/linalg/householder.h"

namespace physinv::linalg {
namespace {

constexpr int kRegisters = kBand / kWidth;
static_assert(kRegisters == 4);

struct Masks {
  /// Row s keeps the lanes from s on.
  alignas(64) std::int64_t keep[kWidth][kWidth];
  constexpr Masks() : keep{} {
    for (Index s = 0; s < kWidth; ++s)
      for (Index l = 0; l < kWidth; ++l) keep[s][l] = l >= s ? -1 : 0;
  }
};
constexpr Masks kMasks;

inline Pack8 from_lane(const Pack8& v, Index first) {
  return masked(physinv::load<Flags>(kMasks.keep[first]), v);
}

/// The columns of register kGroup of a symmetric block times v: their part of
/// the sums w, and in `mirrored` what their rows have above the diagonal.
template <int kGroup>
[[gnu::always_inline]] inline void multiply_columns(const double* d,
                                                    Index step,
                                                    const double* v,
                                                    Pack8 (&w)[kRegisters],
                                                    double* mirrored) {
  for (Index c = kGroup * kWidth; c < (kGroup + 1) * kWidth; ++c) {
    const double* column = d + c * step;
    const Index lane = c - kGroup * kWidth;
    const Pack8 s = broadcast(v[c]);
    // The diagonal entry once: it comes in with the product along the column.
    Pack8 x = from_lane(load(column + kGroup * kWidth), lane);
    w[kGroup] = fma_lanes(x, s, w[kGroup]);
    Pack8 along = from_lane(load(v + kGroup * kWidth), lane) * x;
#pragma GCC unroll 4
    for (int i = kGroup + 1; i < kRegisters; ++i) {
      x = load(column + i * kWidth);
      w[i] = fma_lanes(x, s, w[i]);
      along = fma_lanes(x, load(v + i * kWidth), along);
    }
    mirrored[c] = std::fma(-column[c], v[c], sum_of(along));
  }
}

/// D <- H D H for the symmetric block whose columns start at `d`, `step`
/// apart; only entries on and below the diagonal are touched.
void turn_diagonal(double* d, Index step, double tau, const double* v) {
  // What is mirrored is added last: columns behind c have zeros in row c.
  alignas(64) double w[kBand], mirrored[kBand];
  Pack8 sums[kRegisters] = {};
  multiply_columns<0>(d, step, v, sums, mirrored);
  multiply_columns<1>(d, step, v, sums, mirrored);
  multiply_columns<2>(d, step, v, sums, mirrored);
  multiply_columns<3>(d, step, v, sums, mirrored);
#pragma GCC unroll 4
  for (int i = 0; i < kRegisters; ++i)
    store(w + i * kWidth, tau * (sums[i] + load(mirrored + i * kWidth)));
  axpy(kBand, -0.5 * tau * dot(kBand, w, v), v, w);
  for (Index c = 0; c < kBand; ++c) {
    double* column = d + c * step;
    const Index g = c / kWidth * kWidth;
    const Pack8 sv = broadcast(-v[c]), sw = broadcast(-w[c]);
    const auto change = [&](Index i) {
      return fma_lanes(sv, load(w + i), sw * load(v + i));
    };
    store(column + g, load(column + g) + from_lane(change(g), c - g));
    for (Index i = g + kWidth; i < kBand; i += kWidth)
      store(column + i, load(column + i) + change(i));
  }
}

/// B <- H' (B H): the reflector v of the rows above, then the one that clears
/// the first column of the result, which goes to `next`; returns its tau.
double turn_below(
    double* block, Index step, double tau, const double* v, double* next) {
  Pack8 z[kRegisters] = {};
  for (Index c = 0; c < kBand; ++c) {
    const Pack8 s = broadcast(-tau * v[c]);
#pragma GCC unroll 8
    for (Index i = 0; i < kRegisters; ++i)
      z[i] = fma_lanes(load(block + c * step + i * kWidth), s, z[i]);
  }
  const auto after = [&](Index c, Pack8* x) {
    const Pack8 s = broadcast(v[c]);
#pragma GCC unroll 8
    for (Index i = 0; i < kRegisters; ++i)
      x[i] = fma_lanes(z[i], s, load(block + c * step + i * kWidth));
  };
  Pack8 x[kRegisters], u[kRegisters];
  after(0, x);
#pragma GCC unroll 8
  for (Index i = 0; i < kRegisters; ++i) store(next + i * kWidth, x[i]);
  double beta;
  const double next_tau = reflect(kBand, next, beta);
#pragma GCC unroll 8
  for (Index i = 0; i < kRegisters; ++i) {
    u[i] = load(next + i * kWidth);
    store(block + i * kWidth, Pack8{});
  }
  block[0] = beta;
  for (Index c = 1; c < kBand; ++c) {
    after(c, x);
    Pack8 along{};
#pragma GCC unroll 8
    for (Index i = 0; i < kRegisters; ++i) along = fma_lanes(u[i], x[i], along);
    const Pack8 s = broadcast(-next_tau * sum_of(along));
#pragma GCC unroll 8
    for (Index i = 0; i < kRegisters; ++i)
      store(block + c * step + i * kWidth, fma_lanes(s, u[i], x[i]));
  }
  return next_tau;
}

constexpr Index kGroup = 8;  ///< sweeps that a thread runs together

/// Reflectors of sweep j: rows j + 1, j + 1 + kBand, ...
Index chain(Index n, Index j) { return (n - 1 - j + kBand - 1) / kBand; }

}  // namespace

void BandReduction::reset(Index n) {
  n_ = n;
  // Zeros behind the end: every block is whole, a reflector of a column that
  // ends early has zeros there.
  const auto count = static_cast<std::size_t>((n + 3 * kBand) * (kStep + 1));
  band_ = static_cast<double*>(memory_.reserve(count * sizeof(double)));
  std::fill_n(band_, count, 0.0);
}

void BandReduction::open_sweeps() {
  first_.assign(1, 0);
  for (Index j = 0; j + 2 < n_; ++j)
    first_.push_back(first_.back() + chain(n_, j));
  tau_.resize(static_cast<std::size_t>(first_.back()));
  reflectors_.reserve(static_cast<std::size_t>(first_.back() * kBand) *
                      sizeof(double));
}

/// Clears column `sweep` behind the entry below the diagonal.
void BandReduction::start(Index sweep) {
  double* const v = reflector(first(sweep));
  double* const column = &entry(sweep + 1, sweep);
  std::copy(column, column + kBand, v);
  double beta;
  tau_[static_cast<std::size_t>(first(sweep))] = reflect(kBand, v, beta);
  std::fill(column, column + kBand, 0.0);
  *column = beta;
}

/// A block further: the reflector on both sides, and the next one, for the
/// first column of what it has put below the band.
void BandReduction::step(Index sweep, Index number) {
  const Index at = first(sweep) + number, r = sweep + 1 + number * kBand;
  double* const tau = tau_.data() + at;
  double* const v = reflector(at);
  if (*tau != 0) turn_diagonal(&entry(r, r), kStep, *tau, v);
  if (r + kBand < n_)
    tau[1] = turn_below(&entry(r + kBand, r), kStep, *tau, v, v + kBand);
}

/// Sweeps [begin, end) together. Step s of a sweep needs what step s + 1 of
/// the one before has left, so each follows two steps behind, the first one
/// behind the last of the group before. `own` is how far the last one is.
void BandReduction::run(Index begin,
                        Index end,
                        const WaitableCount* before,
                        WaitableCount& own) {
  const Index lag = 2 * (end - 1 - begin);
  for (Index t = 0; t < chain(n_, begin) + lag; ++t) {
    if (before != nullptr)
      before->wait_for(std::min(t + 2, chain(n_, begin - 1)));
    for (Index j = begin, s = t; j < end && s >= 0; ++j, s -= 2) {
      if (s == 0) start(j);
      if (s < chain(n_, j)) step(j, s);
    }
    if (t >= lag) own.reach(t - lag + 1);
  }
}

void BandReduction::reduce(VectorOut<double> d,
                           VectorOut<double> e,
                           Threads* threads) {
  open_sweeps();
  const Index sweeps = std::max<Index>(n_ - 2, 0);
  const Index groups = (sweeps + kGroup - 1) / kGroup;
  std::vector<WaitableCount> progress(static_cast<std::size_t>(groups));
  std::atomic<Index> next{0};  // groups start in order
  for_blocks(threads, count_of(threads), [&](Index, int) {
    for (Index g; (g = next.fetch_add(1)) < groups;) {
      WaitableCount* const own = progress.data() + g;
      run(g * kGroup,
          std::min((g + 1) * kGroup, sweeps),
          g > 0 ? own - 1 : nullptr,
          *own);
    }
  });
  for (Index j = 0; j < n_; ++j) d(j) = entry(j, j);
  for (Index j = 0; j + 1 < n_; ++j) e(j) = entry(j + 1, j);
}

template <class X>
void BandReduction::apply(X* x) const {
  const double* tau = tau_.data() + tau_.size();
  const auto* v = static_cast<const double*>(reflectors_.data()) +
                  static_cast<Index>(tau_.size()) * kBand;
  for (Index j = n_ - 3; j >= 0; --j)
    for (Index r = j + 1 + (chain(n_, j) - 1) * kBand; r > j; r -= kBand) {
      v -= kBand;
      if (*--tau == 0) continue;
      turn(std::min(kBand, n_ - r), *tau, v, x + r);
    }
}

template void BandReduction::apply(double*) const;
template void BandReduction::apply(Pack8*) const;

}  // namespace physinv::linalg
