/// Times of one forward pass, of one gradient, and of one loss.
#include <benchmark/benchmark.h>

#include "problems/wave_packet/wave_packet.h"

namespace physinv {
namespace {

template <class T>
struct Fixture {
  explicit Fixture(Index n) : y(256, n), y_bar(256, n), x_bar(1, n), loss(n) {
    const auto samples =
        problem.sample(0, n, Rng::root("kernels/wave_packet", 0));
    x = samples.x.template cast<T>();
    given = samples.given.template cast<T>();
    target = samples.y.template cast<T>();
    y_bar = target;
    y = given;
  }

  WavePacket<T> problem;
  Batch<T> x, given, target, y, y_bar, x_bar;
  Vector<double> loss;
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
void BM_wave_packet_forward(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.forward(f.x, f.given, f.y, f.work);
    benchmark::DoNotOptimize(f.y.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

template <class T>
void BM_wave_packet_gradient(benchmark::State& state) {
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
void BM_wave_packet_loss(benchmark::State& state) {
  Fixture<T> f(state.range(0));
  for (auto _ : state) {
    f.problem.loss(f.y, f.target, f.loss);
    benchmark::DoNotOptimize(f.loss.data());
    benchmark::ClobberMemory();
  }
  report(state);
}

BENCHMARK(BM_wave_packet_forward<float>)->Arg(8)->Arg(32)->Arg(256);
BENCHMARK(BM_wave_packet_forward<double>)->Arg(8)->Arg(32)->Arg(256);
BENCHMARK(BM_wave_packet_gradient<float>)->Arg(8)->Arg(32)->Arg(256);
BENCHMARK(BM_wave_packet_gradient<double>)->Arg(8)->Arg(32)->Arg(256);
BENCHMARK(BM_wave_packet_loss<float>)->Arg(32);
BENCHMARK(BM_wave_packet_loss<double>)->Arg(32);

}  // namespace
}  // namespace physinv
