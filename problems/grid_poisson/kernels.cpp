/// Times of one forward pass, one gradient, the Jacobians, and the inverse.
#include <benchmark/benchmark.h>

#include "problems/grid_poisson/grid_poisson.h"

namespace physinv {
namespace {

template <class T>
struct Fixture {
  explicit Fixture(Index n) : x_bar(64, n), j(64 * 64, n) {
    const auto samples =
        problem.sample(0, n, Rng::root("kernels/grid_poisson", 0));
    x = samples.x.template cast<T>();
    given = samples.given.template cast<T>();
    y = y_bar = samples.y.template cast<T>();
  }

  GridPoisson<T> problem;
  Batch<T> x, given, y, y_bar, x_bar, j;
  Workspace work;
  Tape tape;
};

void report(benchmark::State& state) {
  const auto items = state.iterations() * state.range(0);
  state.SetItemsProcessed(items);
  state.counters["per_sample"] = benchmark::Counter(
      static_cast<double>(items),
      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

template <class T>
void BM_grid_poisson_forward(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.forward(f.x, f.given, f.y, f.work);
    benchmark::DoNotOptimize(f.y.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

template <class T>
void BM_grid_poisson_gradient(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.linearize(f.x, f.given, f.y, f.tape);
    f.problem.pullback(f.tape, f.y_bar, f.x_bar, f.work);
    benchmark::DoNotOptimize(f.x_bar.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

template <class T>
void BM_grid_poisson_jacobian(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.jacobian(f.x, f.given, f.j, f.work);
    benchmark::DoNotOptimize(f.j.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

template <class T>
void BM_grid_poisson_invert(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.invert(f.y, f.given, f.x, f.x_bar, f.work);
    benchmark::DoNotOptimize(f.x_bar.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

BENCHMARK(BM_grid_poisson_forward<float>)->Arg(1)->Arg(64)->Arg(1024);
BENCHMARK(BM_grid_poisson_forward<double>)->Arg(1)->Arg(64)->Arg(1024);
BENCHMARK(BM_grid_poisson_gradient<float>)->Arg(1)->Arg(64);
BENCHMARK(BM_grid_poisson_gradient<double>)->Arg(1)->Arg(64);
BENCHMARK(BM_grid_poisson_jacobian<float>)->Arg(16);
BENCHMARK(BM_grid_poisson_jacobian<double>)->Arg(16);
BENCHMARK(BM_grid_poisson_invert<float>)->Arg(64);
BENCHMARK(BM_grid_poisson_invert<double>)->Arg(64);

}  // namespace
}  // namespace physinv
