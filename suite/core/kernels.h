/// What the kernel benchmarks share: the table that names them, the loop that
/// is timed, and counters per second.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace physinv {

/// A row of a table of benchmarks: it runs once for each of its shapes, whose
/// numbers it reads as `state.range(0)`, .. (no shapes: once, without any).
struct Kernel {
  std::string name;
  std::vector<std::vector<std::int64_t>> shapes;
  std::function<void(benchmark::State&)> run;
};

/// Registers a table. Returns true: a constant outside of functions calls it.
inline bool add_kernels(
    const std::vector<Kernel>& table,
    const std::function<void(benchmark::internal::Benchmark&)>& each = {}) {
  for (const auto& [name, shapes, run] : table) {
    auto* const kernel = benchmark::RegisterBenchmark(name.c_str(), run);
    for (const auto& shape : shapes) kernel->Args(shape);
    if (each) each(*kernel);
  }
  return true;
}

/// Counter `what`, which gains `amount` in every iteration, per second.
inline void count_rate(benchmark::State& state,
                       const char* what,
                       double amount) {
  state.counters[what] =
      benchmark::Counter(amount, benchmark::Counter::kIsIterationInvariantRate);
}

/// Times f, whose stores count as read.
template <class F>
void measure(benchmark::State& state, F&& f) {
  for (auto _ : state) {
    f();
    benchmark::ClobberMemory();
  }
}

}  // namespace physinv
