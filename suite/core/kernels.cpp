// Transforms of real signals: the suite's, a signal per lane, and FFTW's of as
// many signals. Arguments: points.
#include "suite/core/kernels.h"

#include <string>
#include <vector>

#include "suite/core/lanes_fft.h"
#include "suite/core/math.h"
#include "suite/core/real_fft.h"
#include "suite/core/workspace.h"

namespace physinv {
namespace {

/// There and back, of some signals: 5/2 n log2(n) flops for each of them and
/// way, as FFTW counts.
template <class Fft, class U, class Y>
void measure_fft(
    benchmark::State& state, const Fft& fft, Index signals, U* u, Y* y) {
  measure(state, [&] {
    fft.forward(u, y);
    fft.inverse(y, u);
  });
  const auto n = static_cast<double>(state.range(0));
  const auto all = static_cast<double>(signals);
  count_rate(state, "flops", 5 * n * math::log2(n) * all);
  state.counters["per_signal"] =
      benchmark::Counter(all,
                         benchmark::Counter::kIsIterationInvariantRate |
                             benchmark::Counter::kInvert);
}

/// A full register.
template <class T>
void lanes(benchmark::State& state) {
  using P = Pack<T, kLanes<T>>;
  const LanesFft<T> fft(state.range(0));
  std::vector<P> u(static_cast<std::size_t>(fft.size())),
      y(static_cast<std::size_t>(fft.spectrum()));
  measure_fft(state, fft, kLanes<T>, u.data(), y.data());
}

template <class T, Codelets codelets, Index signals>
void fftw(benchmark::State& state) {
  const RealFft<T> fft(state.range(0), signals, codelets);
  Workspace work;
  auto u = work.take<T>(fft.signal_stride(), signals);
  auto y = work.take<T>(fft.spectrum_stride(), signals);
  u.setZero();
  measure_fft(state, fft, signals, u.data(), y.data());
}

template <class T>
bool add(const std::string& type) {
  constexpr Index kMany = kLanes<T>;
  const std::vector<std::vector<std::int64_t>> points = {
      {64}, {256}, {1024}, {4096}, {16384}, {65536}};
  return add_kernels(
      {{"fft/lanes" + type, points, lanes<T>},
       {"fft/fftw_scalar" + type, points, fftw<T, Codelets::scalar, kMany>},
       {"fft/fftw_simd" + type, points, fftw<T, Codelets::simd, kMany>},
       {"fft/fftw_scalar_alone" + type, points, fftw<T, Codelets::scalar, 1>},
       {"fft/fftw_simd_alone" + type, points, fftw<T, Codelets::simd, 1>},
       {"fft/fftw_scalar_odd" + type,
        {{63}, {125}, {1001}, {4095}},
        fftw<T, Codelets::scalar, kMany>}});
}

const bool kAdded = add<float>("<float>") && add<double>("<double>");

}  // namespace
}  // namespace physinv
