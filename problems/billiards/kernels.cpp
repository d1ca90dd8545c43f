/// Times of one forward pass, and of one gradient.
#include <benchmark/benchmark.h>

#include "problems/billiards/billiards.h"

namespace physinv {
namespace {

template <class T>
struct Fixture {
  explicit Fixture(Index n)
      : x(2, n), given(2, n), y(2, n), y_bar(2, n), x_bar(2, n) {
    const auto samples = problem.sample_labelled(
        0, n, Rng::root("kernels/billiards", 0).child("data"));
    x = samples.x.template cast<T>();
    given = samples.given.template cast<T>();
    y_bar = given;
  }

  Billiards<T> problem;
  Batch<T> x, given, y, y_bar, x_bar;
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
void BM_billiards_forward(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.forward(f.x, f.given, f.y, f.work);
    benchmark::DoNotOptimize(f.y.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

template <class T>
void BM_billiards_gradient(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.linearize(f.x, f.given, f.y, f.tape);
    f.problem.pullback(f.tape, f.y_bar, f.x_bar, f.work);
    benchmark::DoNotOptimize(f.x_bar.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

BENCHMARK(BM_billiards_forward<float>)->Arg(8)->Arg(128)->Arg(1024);
BENCHMARK(BM_billiards_forward<double>)->Arg(8)->Arg(128)->Arg(1024);
BENCHMARK(BM_billiards_gradient<float>)->Arg(8)->Arg(128)->Arg(1024);
BENCHMARK(BM_billiards_gradient<double>)->Arg(8)->Arg(128)->Arg(1024);

}  // namespace
}  // namespace physinv
