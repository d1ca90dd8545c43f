/// What the kernel benchmarks of networks share.
#pragma once

#include "suite/core/kernels.h"
#include "suite/nn/rows.h"

namespace physinv::nn {

/// Times f; counter FLOPS, `flops` in each iteration.
template <class F>
void measure_flops(benchmark::State& state, double flops, F&& f) {
  measure(state, f);
  count_rate(state, "FLOPS", flops);
}

/// C = A B: C has m rows and n columns, A k columns.
struct ProductShape {
  explicit ProductShape(const benchmark::State& state)
      : m(state.range(0)), n(state.range(1)), k(state.range(2)) {}
  double flops() const { return 2.0 * static_cast<double>(m * n * k); }
  Index m, n, k;
};

/// Of forward passes.
inline const std::vector<std::vector<std::int64_t>> kProductShapes = {
    {128, 128, 128},
    {128, 8, 128},
    {128, 4, 128},
    {128, 128, 32},
    {2, 128, 128},
    {128, 128, 2}};

/// Rows of random numbers with their memory.
template <class T>
struct RandomRows : Rows<T> {
  RandomRows(Index features, Index n) : Rows<T>(nullptr, features, n) {
    memory = Batch<T>::Random(this->stride, features);
    this->data = memory.data();
  }
  Batch<T> memory;
};

}  // namespace physinv::nn
