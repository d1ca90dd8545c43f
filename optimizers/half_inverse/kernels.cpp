// The spectral power and its phases, against Eigen, and against LAPACK where
// the build links it (PHYSINV_BENCH_LAPACK). GFlop/s count 4/3 m^3.
#include "optimizers/half_inverse/kernels.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "optimizers/half_inverse/half_inverse.h"
#include "suite/core/math.h"
#include "suite/core/threads.h"

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

using benchmark::State;

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

void spectral_power(State& state) {
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

/// One more setting for a factored matrix: weights, estimate, way back.
void setting(State& state) {
  const Sample& s = sample(state.range(0));
  SpectralPower spectral;
  Vector<double> v(s.g.size());
  spectral.factor(s.gram, s.g);
  for (auto _ : state) benchmark::DoNotOptimize(spectral.apply({}, v));
}

void fill(Tridiagonalize& reduction, const Batch<double>& gram) {
  const Symmetric a = reduction.matrix(gram.rows());
  for (Index j = 0; j < a.n; ++j)
    std::copy_n(gram.col(j).data() + j, a.n - j, a.row(j) + j);
}

template <Stages kStages>
void reduction(State& state) {
  const Sample& s = sample(state.range(0));
  Tridiagonalize reduction;
  for (auto _ : state) {
    fill(reduction, s.gram);
    reduction.reduce(kStages);
  }
  count_flops(state, reduction_flops(s.g.size()));
}

/// As an update reduces its matrix, in wall time.
void reduction_in_threads(State& state) {
  const Sample& s = sample(state.range(0));
  Threads threads(static_cast<int>(state.range(1)));
  Tridiagonalize reduction(&threads);
  for (auto _ : state) {
    fill(reduction, s.gram);
    reduction.reduce();
  }
  count_flops(state, reduction_flops(s.g.size()));
}

void rotations(State& state) {
  const Sample& s = sample(state.range(0));
  Tridiagonalize reduction;
  fill(reduction, s.gram);
  reduction.reduce();
  TridiagonalQr qr;
  Vector<double> d, e, x;
  for (auto _ : state) {
    d = reduction.diagonal(), e = reduction.off_diagonal();
    x.setOnes(d.size());
    qr.run(d, e, x);
  }
  state.counters["rotations"] = static_cast<double>(qr.rotations());
}

void definite(State& state) {
  Sample s(state.range(0));
  s.gram.diagonal().array() += 1e-3 * s.gram.trace();
  DefiniteSolve solve;
  Vector<double> v(s.g.size());
  PowerReport report;
  for (auto _ : state)
    if (!solve(s.gram, s.g, {.kappa = -1, .tau = 1e-5}, 1e-8, v, report))
      state.SkipWithError("no proof");
}

void eigen(State& state) {
  const Sample& s = sample(state.range(0));
  for (auto _ : state) {
    Eigen::SelfAdjointEigenSolver<Batch<double>> solver(s.gram);
    benchmark::DoNotOptimize(solver.eigenvalues().data());
  }
}

void eigen_reduction(State& state) {
  const Sample& s = sample(state.range(0));
  for (auto _ : state) {
    Eigen::Tridiagonalization<Batch<double>> t(s.gram);
    benchmark::DoNotOptimize(t.packedMatrix().data());
  }
  count_flops(state, reduction_flops(s.g.size()));
}

#ifdef PHYSINV_BENCH_LAPACK
void dsytrd(State& state) {
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

void dsyevd(State& state) {
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

#endif

std::vector<Kernel> all() {
  const std::vector<std::vector<std::int64_t>> some = {{512}, {1024}, {2048}};
  const std::vector<std::vector<std::int64_t>> sizes = {
      {448}, {512}, {1024}, {2048}, {4096}};
  return {{"hig/spectral_power", sizes, spectral_power},
          {"hig/further_setting", sizes, setting},
          {"hig/one_stage", sizes, reduction<Stages::one>},
          {"hig/two_stages", sizes, reduction<Stages::two>},
          {"hig/tridiagonal_qr", sizes, rotations},
          {"hig/definite_solve", sizes, definite},
          {"hig/eigen_eigenvectors", some, eigen},
          {"hig/eigen_reduction", some, eigen_reduction},
#ifdef PHYSINV_BENCH_LAPACK
          {"hig/lapack_dsytrd", sizes, dsytrd},
          {"hig/lapack_dsyevd", sizes, dsyevd}
#endif
  };
}

const bool kAdded =
    add_kernels(all(), in_milliseconds("m")) &&
    add_kernels(
        {{"hig/reduction",
          {{512, 1}, {512, 2}, {1024, 1}, {1024, 2}, {4096, 1}, {4096, 2}},
          reduction_in_threads}},
        [](benchmark::internal::Benchmark& kernel) {
          kernel.ArgNames({"m", "threads"})
              ->Unit(benchmark::kMillisecond)
              ->UseRealTime();
        });

}  // namespace
}  // namespace physinv::hig
