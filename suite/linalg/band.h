/// Band (32 below the diagonal) to tridiagonal by chasing bulges with
/// reflectors of length 32; 6 n^2 32 flops, all in cache. The first
/// coordinate is left alone.
#pragma once

#include <vector>

#include "suite/core/batch.h"
#include "suite/core/buffer.h"

namespace physinv {
class WaitableCount;
class Threads;
}  // namespace physinv

namespace physinv::linalg {

inline constexpr Index kBand = 32;

class BandReduction {
 public:
  /// Opens an n x n band matrix of zeros.
  void reset(Index n);

  /// Entry (i, j), 0 <= i - j <= kBand.
  double& entry(Index i, Index j) { return band_[j * (kStep + 1) + i - j]; }

  /// Sweeps follow each other over the threads; no bit depends on them.
  void reduce(VectorOut<double> d, VectorOut<double> e, Threads* threads);

  /// x <- Q x for T = Q^T A Q. X is double, or Pack8 for
  /// eight vectors side by side.
  template <class X>
  void apply(X* x) const;

  std::size_t bytes() const { return memory_.bytes() + reflectors_.bytes(); }

 private:
  /// From a column to the next within one row. At least 2 kBand - 1 for the
  /// bulge; columns of a block then lie in different cache sets.
  static constexpr Index kStep = 72;

  void open_sweeps();
  void start(Index sweep);
  void step(Index sweep, Index number);
  void run(Index begin,
           Index end,
           const WaitableCount* before,
           WaitableCount& own);
  /// Place of a sweep's first reflector.
  Index first(Index sweep) const {
    return first_[static_cast<std::size_t>(sweep)];
  }
  double* reflector(Index i) {
    return static_cast<double*>(reflectors_.data()) + i * kBand;
  }

  Index n_ = 0;
  double* band_ = nullptr;
  Buffer memory_, reflectors_;
  std::vector<double> tau_;
  std::vector<Index> first_;
};

}  // namespace physinv::linalg
