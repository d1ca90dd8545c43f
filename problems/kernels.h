/// Google Benchmarks that problems share: one forward pass, one gradient, and
/// the Jacobians of a batch. Counter per_sample: seconds per sample.
#pragma once

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <utility>
#include <vector>

#include "suite/core/any_problem.h"

namespace physinv {

/// A problem with n of its samples and memory for all of its operations.
template <class T>
struct KernelFixture {
  KernelFixture(const ProblemRecipe& recipe, Index n) : problem(recipe) {
    const auto s =
        recipe.make<double>()->sample_labelled(0, n, Rng::root("kernels", 0));
    x = s.x.template cast<T>();
    given = s.given.template cast<T>();
    y_bar = y = target = s.y.template cast<T>();
    x_bar.resize(x.rows(), n);
  }

  AnyProblem<T> problem;
  Batch<T> x, given, target, y, y_bar, x_bar, j;
  Workspace work;
  Tape tape;
};

inline void report_per_sample(benchmark::State& state) {
  const auto items = state.iterations() * state.range(0);
  state.SetItemsProcessed(items);
  state.counters["per_sample"] = benchmark::Counter(
      static_cast<double>(items),
      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// Sizes of batches to time.
struct KernelSizes {
  std::vector<Index> forward, gradient, jacobian = {};
};

/// Registers BM_<problem>_<what><T> for both precisions.
class Kernels {
 public:
  Kernels(ProblemRecipe recipe, const KernelSizes& sizes)
      : recipe_(std::move(recipe)) {
    add("forward", sizes.forward, [](auto& f) {
      f.problem.forward(f.x, f.given, f.y, f.work);
    });
    add("gradient", sizes.gradient, [](auto& f) {
      f.problem.linearize(f.x, f.given, f.y, f.tape);
      f.problem.pullback(f.tape, f.y_bar, f.x_bar, f.work);
    });
    add("jacobian", sizes.jacobian, [](auto& f) {
      f.j.resize(f.y.rows() * f.x.rows(), f.x.cols());
      f.problem.jacobian(f.x, f.given, f.j, f.work);
    });
  }

  /// `run(fixture)` is what is timed.
  template <class F>
  Kernels& add(const char* what, const std::vector<Index>& sizes, F run) {
    add_in<float>("float", what, sizes, run);
    add_in<double>("double", what, sizes, run);
    return *this;
  }

 private:
  template <class T, class F>
  void add_in(const char* type,
              const char* what,
              const std::vector<Index>& sizes,
              F run) {
    if (sizes.empty()) return;
    auto* registered = benchmark::RegisterBenchmark(
        fmt::format("BM_{}_{}<{}>", recipe_.name, what, type).c_str(),
        [run, recipe = recipe_](benchmark::State& state) mutable {
          KernelFixture<T> f(recipe, state.range(0));
          for (auto _ : state) {
            run(f);
            benchmark::ClobberMemory();
          }
          report_per_sample(state);
        });
    for (const Index n : sizes) registered->Arg(n);
  }

  ProblemRecipe recipe_;
};

}  // namespace physinv
