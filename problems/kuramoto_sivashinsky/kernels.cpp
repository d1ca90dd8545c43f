/// Times of a simulation and of a gradient, and of the bare transforms that
/// they need: four real ones of 128 points per step and way. The counters are
/// seconds per sample and step.
#include "problems/kernels.h"

#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"

namespace physinv {
namespace {

constexpr Index kCells = 128;

void report(benchmark::State& state, double items, double operations) {
  const double all = static_cast<double>(state.iterations()) * items;
  state.SetItemsProcessed(static_cast<std::int64_t>(all));
  state.counters["per_sample_step"] = benchmark::Counter(
      all * operations,
      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

template <class T>
struct Fixture : KernelFixture<T> {
  Fixture(Index n, double budget)
      : KernelFixture<T>(
            problems::kuramoto_sivashinsky({.tape_budget = budget}), n) {}
  static double steps() {
    return static_cast<double>(KuramotoSivashinskyOptions{}.steps);
  }
};

template <class T>
void BM_kuramoto_sivashinsky_forward(benchmark::State& state) {
  Fixture<T> f(state.range(0), 0);
  for (auto _ : state) {
    f.problem.forward(f.x, f.given, f.y, f.work);
    benchmark::ClobberMemory();
  }
  report(state, static_cast<double>(state.range(0)), f.steps());
}

/// The second argument is the budget of the tape in megabytes: 0 makes every
/// state twice, and all fit into 1000.
template <class T>
void BM_kuramoto_sivashinsky_gradient(benchmark::State& state) {
  Fixture<T> f(state.range(0), 1e6 * static_cast<double>(state.range(1)));
  for (auto _ : state) {
    f.problem.linearize(f.x, f.given, f.y, f.tape);
    f.problem.pullback(f.tape, f.y_bar, f.x_bar, f.work);
    benchmark::ClobberMemory();
  }
  report(state, static_cast<double>(state.range(0)), f.steps());
}

#define PHYSINV_KS(T)                            \
  BENCHMARK(BM_kuramoto_sivashinsky_forward<T>)  \
      ->ArgsProduct({{1, 2, 4, 8, 128}});        \
  BENCHMARK(BM_kuramoto_sivashinsky_gradient<T>) \
      ->ArgsProduct({{1, 8, 128}, {0, 4, 1000}}) \
      ->ArgsProduct({{2, 4}, {1000}})
PHYSINV_KS(float);
PHYSINV_KS(double);
#undef PHYSINV_KS

}  // namespace
}  // namespace physinv
