/// Times of one forward pass, one gradient, and the Jacobians.
#include <benchmark/benchmark.h>

#include "problems/oscillators/oscillators.h"

namespace physinv {
namespace {

template <class T>
struct Fixture {
  explicit Fixture(Index n) : y(4, n), x_bar(96, n), j(4 * 96, n) {
    const auto samples =
        problem.sample_labelled(0, n, Rng::root("kernels/oscillators", 0));
    x = samples.x.template cast<T>();
    given = samples.given.template cast<T>();
    y_bar = samples.y.template cast<T>();
  }

  Oscillators<T> problem;
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
void BM_oscillators_forward(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.forward(f.x, f.given, f.y, f.work);
    benchmark::DoNotOptimize(f.y.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

template <class T>
void BM_oscillators_gradient(benchmark::State& state) {
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
void BM_oscillators_jacobian(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.jacobian(f.x, f.given, f.j, f.work);
    benchmark::DoNotOptimize(f.j.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

BENCHMARK(BM_oscillators_forward<float>)->Arg(1)->Arg(128)->Arg(4096);
BENCHMARK(BM_oscillators_forward<double>)->Arg(1)->Arg(128)->Arg(4096);
BENCHMARK(BM_oscillators_gradient<float>)->Arg(1)->Arg(128)->Arg(512);
BENCHMARK(BM_oscillators_gradient<double>)->Arg(1)->Arg(128)->Arg(512);
BENCHMARK(BM_oscillators_jacobian<float>)->Arg(1)->Arg(128);
BENCHMARK(BM_oscillators_jacobian<double>)->Arg(1)->Arg(128);

}  // namespace
}  // namespace physinv
