/// Counters of the kernel benchmarks.
#pragma once

#include <benchmark/benchmark.h>

#include <cmath>

#include "suite/core/batch.h"
#include "suite/core/math.h"

namespace physinv::hig {

/// Of a symmetric matrix to tridiagonal form.
inline double reduction_flops(Index m) {
  return 4.0 / 3 * math::pow(static_cast<double>(m), 3);
}

inline void count_flops(benchmark::State& state, double flops) {
  state.counters["GFlop/s"] =
      benchmark::Counter(flops * 1e-9 * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}

}  // namespace physinv::hig
