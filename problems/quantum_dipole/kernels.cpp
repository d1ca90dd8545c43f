/// Times of one forward pass, one gradient, and the Jacobians.
#include <benchmark/benchmark.h>

#include "problems/quantum_dipole/quantum_dipole.h"

namespace physinv {
namespace {

template <class T>
struct Fixture {
  explicit Fixture(Index n) : y(28, n), x_bar(384, n), j(28 * 384, n) {
    const auto samples =
        problem.sample_labelled(0, n, Rng::root("kernels/quantum_dipole", 0));
    x = samples.x.template cast<T>();
    given = samples.given.template cast<T>();
    y_bar = samples.y.template cast<T>();
  }

  QuantumDipole<T> problem;
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
void BM_quantum_dipole_forward(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.forward(f.x, f.given, f.y, f.work);
    benchmark::DoNotOptimize(f.y.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

template <class T>
void BM_quantum_dipole_gradient(benchmark::State& state) {
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
void BM_quantum_dipole_jacobian(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.jacobian(f.x, f.given, f.j, f.work);
    benchmark::DoNotOptimize(f.j.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

BENCHMARK(BM_quantum_dipole_forward<float>)->Arg(1)->Arg(16)->Arg(1024);
BENCHMARK(BM_quantum_dipole_forward<double>)->Arg(1)->Arg(16)->Arg(1024);
BENCHMARK(BM_quantum_dipole_gradient<float>)->Arg(1)->Arg(16)->Arg(256);
BENCHMARK(BM_quantum_dipole_gradient<double>)->Arg(1)->Arg(16)->Arg(256);
BENCHMARK(BM_quantum_dipole_jacobian<float>)->Arg(1)->Arg(16);
BENCHMARK(BM_quantum_dipole_jacobian<double>)->Arg(1)->Arg(16);

}  // namespace
}  // namespace physinv
