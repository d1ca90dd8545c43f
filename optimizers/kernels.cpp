// Timings of the classical optimizers without a physics problem.
#include <benchmark/benchmark.h>

#include <cmath>
#include <span>
#include <vector>

#include "optimizers/bfgs.h"
#include "optimizers/drive.h"
#include "optimizers/steps/bfgs_update.h"

namespace physinv {
namespace {

void rosenbrock(std::span<const Index>,
                BatchIn<double> x,
                VectorOut<double> loss,
                BatchOut<double> gradient) {
  for (Index i = 0; i < x.cols(); ++i) {
    const double a = 1 - x(0, i), b = x(1, i) - x(0, i) * x(0, i);
    loss(i) = a * a + 100 * b * b;
    gradient(0, i) = -2 * a - 400 * x(0, i) * b;
    gradient(1, i) = 200 * b;
  }
}

void bm_bfgs_update(benchmark::State& state) {
  const Index d = state.range(0);
  std::vector<double> h(static_cast<std::size_t>(d * d));
  Vector<double> s(d), y(d), scratch(d);
  for (Index i = 0; i < d; ++i) {
    s(i) = std::sin(0.7 * static_cast<double>(i) + 1);
    y(i) = (1 + 0.5 * std::cos(static_cast<double>(i))) * s(i);
  }
  dense::set_identity(d, h.data());
  for (auto _ : state) {
    dense::bfgs_update(d, s.data(), y.data(), h.data(), scratch.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(bm_bfgs_update)
    ->Name("optimizers/bfgs_update")
    ->ArgName("d")
    ->Arg(2)
    ->Arg(16)
    ->Arg(128);

/// Whole runs of 128 problems, as a table of billiards needs them.
void bm_bfgs_batch(benchmark::State& state) {
  const Index n = 128;
  Batch<double> x0(2, n);
  for (Index i = 0; i < n; ++i) {
    x0(0, i) = 2 * std::sin(static_cast<double>(i));
    x0(1, i) = 2 * std::cos(1.7 * static_cast<double>(i));
  }
  Bfgs solver;
  for (auto _ : state) drive(solver, rosenbrock, x0);
  double evaluations = 0;
  for (const Index e : solver.evaluations())
    evaluations += static_cast<double>(e);
  state.counters["evaluations"] = evaluations;
  state.counters["rounds"] = static_cast<double>(solver.rounds());
  state.SetItemsProcessed(state.iterations() * n);
}
BENCHMARK(bm_bfgs_batch)->Name("optimizers/bfgs_rosenbrock_128");

}  // namespace
}  // namespace physinv
