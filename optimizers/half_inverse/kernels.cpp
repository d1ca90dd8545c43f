// The spectral power and its phases, against Eigen, and against LAPACK where
// the build links it (PHYSINV_BENCH_LAPACK). GFlop/s count 4/3 m^3.
#include "optimizers/half_inverse/kernels.h"

#include <benchmark/benchmark.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "optimizers/half_inverse/half_inverse.h"
#include "suite/core/math.h"

#ifdef PHYSINV_BENCH_LAPACK
extern "C" {
void dsytrd_(const char*,
             const int*,
             double*,
             const int*,
             double*,
             double*,
             double*,
             double*,
             const int*,
             int*);
void dsyevd_(const char*,
             const char*,
             const int*,
             double*,
             const int*,
             double*,
             double*,
             const int*,
             int*,
             const int*,
             int*);
}
#endif

namespace physinv::hig {

using namespace linalg;
namespace {

/// J J^T with singular values over six decades, and a g.
struct Sample {
  Batch<double> gram;
  Vector<double> g;
  explicit Sample(Index m) : gram(m, m), g(m) {
    Batch<double> j(m, m + 8);
    std::uint32_t state = 1;
    const auto next = [&] {
      state = state * 1664525u + 1013904223u;
      return static_cast<double>(state) / 2147483648.0 - 1;
    };
    for (Index c = 0; c < j.cols(); ++c) {
      const double scale =
          math::pow(10, -6.0 * static_cast<double>(c) / static_cast<double>(m));
      for (Index r = 0; r < m; ++r) j(r, c) = next() * scale;
    }
    for (Index i = 0; i < m; ++i) g(i) = next();
    gram.setZero();
    gram.selfadjointView<Eigen::Lower>().rankUpdate(j);
    gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  }
};

const Sample& sample(Index m) {
  static std::vector<std::pair<Index, Sample>> made;
  for (const auto& [size, s] : made)
    if (size == m) return s;
  made.clear();
  return made.emplace_back(m, Sample(m)).second;
}

void sizes(benchmark::internal::Benchmark* b) {
  b->ArgName("m")->Unit(benchmark::kMillisecond);
  for (const int m : {448, 512, 1024, 2048, 4096}) b->Arg(m);
}

void bm_spectral_power(benchmark::State& state) {
  const Sample& s = sample(state.range(0));
  SpectralPower spectral;
  Vector<double> v(s.g.size());
  for (auto _ : state) {
    spectral.factor(s.gram, s.g);
    benchmark::DoNotOptimize(spectral.apply({}, v));
  }
  state.counters["rotations"] = static_cast<double>(spectral.rotations());
  count_flops(state, reduction_flops(s.g.size()));
}
BENCHMARK(bm_spectral_power)->Name("hig/spectral_power")->Apply(sizes);

/// One more setting for a factored matrix: weights, estimate, way back.
void bm_setting(benchmark::State& state) {
  const Sample& s = sample(state.range(0));
  SpectralPower spectral;
  Vector<double> v(s.g.size());
  spectral.factor(s.gram, s.g);
  for (auto _ : state) benchmark::DoNotOptimize(spectral.apply({}, v));
}
BENCHMARK(bm_setting)->Name("hig/further_setting")->Apply(sizes);

template <Stages kStages>
void bm_reduction(benchmark::State& state) {
  const Sample& s = sample(state.range(0));
  Tridiagonalize reduction;
  for (auto _ : state) {
    const Symmetric a = reduction.matrix(s.g.size());
    for (Index j = 0; j < a.n; ++j)
      std::copy_n(s.gram.col(j).data() + j, a.n - j, a.row(j) + j);
    reduction.reduce(kStages);
  }
  count_flops(state, reduction_flops(s.g.size()));
}
BENCHMARK(bm_reduction<Stages::one>)->Name("hig/one_stage")->Apply(sizes);
BENCHMARK(bm_reduction<Stages::two>)->Name("hig/two_stages")->Apply(sizes);

void bm_rotations(benchmark::State& state) {
  const Sample& s = sample(state.range(0));
  Tridiagonalize reduction;
  const Symmetric a = reduction.matrix(s.g.size());
  for (Index j = 0; j < a.n; ++j)
    std::copy_n(s.gram.col(j).data() + j, a.n - j, a.row(j) + j);
  reduction.reduce();
  TridiagonalQr qr;
  Vector<double> d, e, x;
  for (auto _ : state) {
    d = reduction.diagonal(), e = reduction.off_diagonal();
    x.setOnes(a.n);
    qr.run(d, e, x);
  }
  state.counters["rotations"] = static_cast<double>(qr.rotations());
}
BENCHMARK(bm_rotations)->Name("hig/tridiagonal_qr")->Apply(sizes);

void bm_definite(benchmark::State& state) {
  Sample s(state.range(0));
  s.gram.diagonal().array() += 1e-3 * s.gram.trace();
  DefiniteSolve solve;
  Vector<double> v(s.g.size());
  PowerReport report;
  for (auto _ : state)
    if (!solve(s.gram, s.g, {.kappa = -1, .tau = 1e-5}, 1e-8, v, report))
      state.SkipWithError("no proof");
}
BENCHMARK(bm_definite)->Name("hig/definite_solve")->Apply(sizes);

void bm_eigen(benchmark::State& state) {
  const Sample& s = sample(state.range(0));
  for (auto _ : state) {
    Eigen::SelfAdjointEigenSolver<Batch<double>> solver(s.gram);
    benchmark::DoNotOptimize(solver.eigenvalues().data());
  }
}
BENCHMARK(bm_eigen)
    ->Name("hig/eigen_eigenvectors")
    ->ArgName("m")
    ->Unit(benchmark::kMillisecond)
    ->Arg(512)
    ->Arg(1024)
    ->Arg(2048);

void bm_eigen_reduction(benchmark::State& state) {
  const Sample& s = sample(state.range(0));
  for (auto _ : state) {
    Eigen::Tridiagonalization<Batch<double>> t(s.gram);
    benchmark::DoNotOptimize(t.packedMatrix().data());
  }
  count_flops(state, reduction_flops(s.g.size()));
}
BENCHMARK(bm_eigen_reduction)
    ->Name("hig/eigen_reduction")
    ->ArgName("m")
    ->Unit(benchmark::kMillisecond)
    ->Arg(512)
    ->Arg(1024)
    ->Arg(2048);

#ifdef PHYSINV_BENCH_LAPACK
void bm_dsytrd(benchmark::State& state) {
  const Sample& s = sample(state.range(0));
  const int m = static_cast<int>(s.g.size()), work_size = 64 * m;
  Vector<double> d(m), e(m), tau(m), work(work_size);
  Batch<double> a;
  int info = 0;
  for (auto _ : state) {
    a = s.gram;
    dsytrd_("L",
            &m,
            a.data(),
            &m,
            d.data(),
            e.data(),
            tau.data(),
            work.data(),
            &work_size,
            &info);
  }
  count_flops(state, reduction_flops(m));
}
BENCHMARK(bm_dsytrd)->Name("hig/lapack_dsytrd")->Apply(sizes);

void bm_dsyevd(benchmark::State& state) {
  const Sample& s = sample(state.range(0));
  const int m = static_cast<int>(s.g.size());
  const int size = 1 + 6 * m + 2 * m * m, integers = 3 + 5 * m;
  Vector<double> d(m), work(size);
  std::vector<int> iwork(static_cast<std::size_t>(integers));
  Batch<double> a;
  int info = 0;
  for (auto _ : state) {
    a = s.gram;
    dsyevd_("V",
            "L",
            &m,
            a.data(),
            &m,
            d.data(),
            work.data(),
            &size,
            iwork.data(),
            &integers,
            &info);
  }
}
BENCHMARK(bm_dsyevd)->Name("hig/lapack_dsyevd")->Apply(sizes);
#endif

}  // namespace
}  // namespace physinv::hig
