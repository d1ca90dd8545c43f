#include "suite/linalg/band.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "suite/linalg/householder.h"

namespace physinv::linalg {
namespace {

constexpr Index kRegisters = kBand / kWidth;

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

/// D <- H D H for the symmetric block whose columns start at `d`, `step`
/// apart; only entries on and below the diagonal are touched.
void turn_diagonal(double* d, Index step, double tau, const double* v) {
  alignas(64) double w[kBand] = {};
  for (Index c = 0; c < kBand; ++c) {
    const double* column = d + c * step;
    const Index g = c / kWidth * kWidth;
    const Pack8 s = broadcast(v[c]);
    // The diagonal entry once: it comes in with the product along the column.
    Pack8 x = from_lane(load(column + g), c - g);
    store(w + g, fma_lanes(x, s, load(w + g)));
    Pack8 mirrored = from_lane(load(v + g), c - g) * x;
    for (Index i = g + kWidth; i < kBand; i += kWidth) {
      x = load(column + i);
      store(w + i, fma_lanes(x, s, load(w + i)));
      mirrored = fma_lanes(x, load(v + i), mirrored);
    }
    w[c] += std::fma(-column[c], v[c], sum_of(mirrored));
  }
  for (Index i = 0; i < kBand; ++i) w[i] *= tau;
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

void BandReduction::reduce(VectorOut<double> d, VectorOut<double> e) {
  Index total = 0;
  for (Index j = 0; j + 2 < n_; ++j) total += chain(n_, j);
  tau_.resize(static_cast<std::size_t>(total));
  auto* v = static_cast<double*>(reflectors_.reserve(
      static_cast<std::size_t>(total * kBand) * sizeof(double)));
  double* tau = tau_.data();
  for (Index j = 0; j + 2 < n_; ++j) {
    double* column = &entry(j + 1, j);
    std::copy(column, column + kBand, v);
    double beta;
    *tau = reflect(kBand, v, beta);
    std::fill(column, column + kBand, 0.0);
    *column = beta;
    for (Index r = j + 1;; r += kBand) {
      if (*tau != 0) turn_diagonal(&entry(r, r), kStep, *tau, v);
      if (r + kBand >= n_) break;
      tau[1] = turn_below(&entry(r + kBand, r), kStep, *tau, v, v + kBand);
      ++tau, v += kBand;
    }
    ++tau, v += kBand;
  }
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
