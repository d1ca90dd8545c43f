/// What the kernel benchmarks of networks share.
#pragma once

#include <benchmark/benchmark.h>

#include "suite/nn/lanes.h"

namespace physinv::nn {

inline void flops(benchmark::State& state, double per_iteration) {
  state.counters["FLOPS"] = benchmark::Counter(
      per_iteration, benchmark::Counter::kIsIterationInvariantRate);
}

inline double products(Index m, Index n, Index k) {
  return 2.0 * static_cast<double>(m * n * k);
}

/// Rows of random numbers, and their memory.
template <class T>
struct LaneBlock {
  LaneBlock(Index rows, Index samples) : lanes(nullptr, rows, samples) {
    buffer.resize(lanes.stride, rows);
    buffer.setRandom();
    lanes.data = buffer.data();
  }
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> buffer;
  Lanes<T> lanes;
};

}  // namespace physinv::nn
