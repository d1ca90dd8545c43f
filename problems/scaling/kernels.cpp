// Many trajectories of the chapter's steps; per_step: seconds of one step of
// one trajectory.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "problems/scaling/trajectories.h"
#include "suite/core/rng.h"

namespace physinv {
namespace {

struct Named {
  const char* name;
  ScalingFlow flow;
};
constexpr Named kFlows[] = {
    {"gd", {ScalingStep::gradient, 1, 0.03, 50}},
    {"newton", {ScalingStep::newton, 1, 0.3, 50}},
    {"ig", {ScalingStep::inverse_gradient, 1, 0.3, 50}},
    {"pg", {ScalingStep::inverse_simulator, 1, 0.3, 50}},
    {"squared/gd", {ScalingStep::gradient, 2, 0.01, 10}},
    {"squared/newton", {ScalingStep::newton, 2, 1.0 / 3, 10}},
    {"squared/ig", {ScalingStep::inverse_gradient, 2, 0.3, 10}},
    {"squared/pg", {ScalingStep::inverse_simulator, 2, 0.3, 10}}};

template <class T>
Vector<T> uniform(Index n, const char* stream, double from, double to) {
  Stream draw = Rng::root("scaling", 0).child(stream).stream();
  return Vector<T>::NullaryExpr(
      n, [&](Index) { return static_cast<T>(draw.uniform(from, to)); });
}

template <class T>
void trajectories(benchmark::State& state, const ScalingFlow& flow) {
  const Index n = state.range(0);
  const double from = flow.power == 2 ? 0.5 : 0, to = flow.power == 2 ? 3.5 : 1;
  const Vector<T> alpha = flow.power == 2 ? Vector<T>(Vector<T>::Ones(n))
                                          : uniform<T>(n, "alpha", 1, 5);
  const Vector<T> a = uniform<T>(n, "x1", from, to),
                  b = uniform<T>(n, "x2", from, to);
  Vector<T> x1(n), x2(n);
  for (auto _ : state) {
    advance<T>(flow, alpha, a, b, x1, x2);
    benchmark::DoNotOptimize(x2.data());
  }
  state.counters["per_step"] =
      benchmark::Counter(double(n * flow.steps),
                         benchmark::Counter::kIsIterationInvariantRate |
                             benchmark::Counter::kInvert);
}

template <class T>
void add(const char* precision) {
  for (const auto& [name, flow] : kFlows)
    benchmark::RegisterBenchmark(
        fmt::format("scaling/{}/{}", name, precision).c_str(),
        [flow = flow](benchmark::State& s) { trajectories<T>(s, flow); })
        ->Arg(1000)
        ->Arg(100'000);
}

const bool kAdded = [] {
  add<float>("f32");
  add<double>("f64");
  return true;
}();

}  // namespace
}  // namespace physinv
