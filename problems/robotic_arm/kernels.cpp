/// Times of one forward pass, and of one gradient.
#include <benchmark/benchmark.h>

#include "problems/robotic_arm/robotic_arm.h"

namespace physinv {
namespace {

template <class T>
struct Fixture {
  explicit Fixture(Index n) : given(0, n), y(2, n), x_bar(4, n) {
    const auto samples =
        problem.sample(0, n, Rng::root("kernels/robotic_arm", 0));
    x = samples.x.template cast<T>();
    y_bar = samples.y.template cast<T>();
  }

  RoboticArm<T> problem;
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
void BM_robotic_arm_forward(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.forward(f.x, f.given, f.y, f.work);
    benchmark::DoNotOptimize(f.y.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

template <class T>
void BM_robotic_arm_gradient(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.linearize(f.x, f.given, f.y, f.tape);
    f.problem.pullback(f.tape, f.y_bar, f.x_bar, f.work);
    benchmark::DoNotOptimize(f.x_bar.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

BENCHMARK(BM_robotic_arm_forward<float>)->Arg(8)->Arg(128)->Arg(1024);
BENCHMARK(BM_robotic_arm_forward<double>)->Arg(8)->Arg(128)->Arg(1024);
BENCHMARK(BM_robotic_arm_gradient<float>)->Arg(8)->Arg(128)->Arg(1024);
BENCHMARK(BM_robotic_arm_gradient<double>)->Arg(8)->Arg(128)->Arg(1024);

}  // namespace
}  // namespace physinv
