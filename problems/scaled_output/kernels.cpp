/// Times of one gradient.
#include <benchmark/benchmark.h>

#include "problems/scaled_output/scaled_output.h"

namespace physinv {
namespace {

template <class T>
void BM_scaled_output_gradient(benchmark::State& state) {
  const ScaledOutput<T> problem;
  const Index n = state.range(0);
  const auto s = problem.sample(0, n, Rng::root("kernels/scaled_output", 0))
                     .template cast<T>();
  Batch<T> y(2, n), x_bar(2, n);
  Workspace work;
  Tape tape;
  for (auto _ : state) {
    problem.linearize(s.x, s.given, y, tape);
    problem.pullback(tape, s.y, x_bar, work);
    benchmark::DoNotOptimize(x_bar.data());
    benchmark::ClobberMemory();
  }
  const auto items = state.iterations() * n;
  state.SetItemsProcessed(items);
  state.counters["per_sample"] = benchmark::Counter(
      static_cast<double>(items),
      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(BM_scaled_output_gradient<float>)->Arg(256);
BENCHMARK(BM_scaled_output_gradient<double>)->Arg(256);

}  // namespace
}  // namespace physinv
