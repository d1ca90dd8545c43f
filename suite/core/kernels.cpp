// Transforms of real signals: the suite's, a signal per lane, beside FFTW's of
// as many signals. Arguments: points.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "suite/core/lanes_fft.h"
#include "suite/core/math.h"
#include "suite/core/real_fft.h"
#include "suite/core/workspace.h"

namespace physinv {
namespace {

template <class T>
constexpr Index kSignals = kLanes<T>;

/// 5/2 n log2(n) per signal and direction, as FFTW counts.
void report(benchmark::State& state, Index signals) {
  const auto n = static_cast<double>(state.range(0));
  state.counters["flops"] =
      benchmark::Counter(5 * n * math::log2(n) * static_cast<double>(signals),
                         benchmark::Counter::kIsIterationInvariantRate);
  state.counters["per_signal"] =
      benchmark::Counter(static_cast<double>(signals),
                         benchmark::Counter::kIsIterationInvariantRate |
                             benchmark::Counter::kInvert);
}

/// There and back, of a full register.
template <class T>
void lanes(benchmark::State& state) {
  using P = Pack<T, kLanes<T>>;
  const LanesFft<T> fft(state.range(0));
  std::vector<P> u(static_cast<std::size_t>(fft.size())),
      y(static_cast<std::size_t>(fft.spectrum()));
  for (auto _ : state) {
    fft.forward(u.data(), y.data());
    fft.inverse(y.data(), u.data());
    benchmark::ClobberMemory();
  }
  report(state, kSignals<T>);
}

template <class T, Codelets codelets, Index signals>
void fftw(benchmark::State& state) {
  const RealFft<T> fft(state.range(0), signals, codelets);
  Workspace work;
  auto u = work.take<T>(fft.signal_stride(), signals);
  auto y = work.take<T>(fft.spectrum_stride(), signals);
  u.setZero();
  for (auto _ : state) {
    fft.forward(u.data(), y.data());
    fft.inverse(y.data(), u.data());
    benchmark::ClobberMemory();
  }
  report(state, signals);
}

template <class T>
void add(const std::string& type) {
  const auto named = [&](const char* what, auto* run) {
    return benchmark::RegisterBenchmark(
        fmt::format("fft/{}<{}>", what, type).c_str(), run);
  };
  constexpr Index kMany = kSignals<T>;
  for (auto* b : {named("lanes", lanes<T>),
                  named("fftw_scalar", fftw<T, Codelets::scalar, kMany>),
                  named("fftw_simd", fftw<T, Codelets::simd, kMany>),
                  named("fftw_scalar_alone", fftw<T, Codelets::scalar, 1>),
                  named("fftw_simd_alone", fftw<T, Codelets::simd, 1>)})
    b->RangeMultiplier(4)->Range(64, 65536);
  named("fftw_scalar_odd", fftw<T, Codelets::scalar, kMany>)
      ->Arg(63)
      ->Arg(125)
      ->Arg(1001)
      ->Arg(4095);
}

const bool kAdded = (add<float>("float"), add<double>("double"), true);

}  // namespace
}  // namespace physinv
