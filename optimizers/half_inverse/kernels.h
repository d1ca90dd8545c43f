/// What the benchmarks of half-inverse updates share.
#pragma once

#include "suite/core/batch.h"
#include "suite/core/kernels.h"
#include "suite/core/math.h"

namespace physinv::hig {

/// Of a symmetric matrix to tridiagonal form.
inline double reduction_flops(Index m) {
  return 4.0 / 3 * math::pow(static_cast<double>(m), 3);
}

inline void count_flops(benchmark::State& state, double flops) {
  count_rate(state, "GFlop/s", 1e-9 * flops);
}

/// Of a table in milliseconds, with a name for the argument.
inline auto in_milliseconds(const char* argument) {
  return [=](benchmark::internal::Benchmark& kernel) {
    kernel.ArgName(argument)->Unit(benchmark::kMillisecond);
  };
}

}  // namespace physinv::hig
