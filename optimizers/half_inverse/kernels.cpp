// The spectral power and its phases, against Eigen, and against LAPACK where
// the build links it (PHYSINV_BENCH_LAPACK). GFlop/s count 4/3 m^3. At the end
// an update of network and solver and its parts, at the experiments' sizes.
#include <benchmark/benchmark.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "optimizers/half_inverse/half_inverse.h"
#include "optimizers/half_inverse/structured_gram.h"
#include "optimizers/half_inverse_step.h"
#include "suite/nn/cnn.h"
#include "suite/nn/mlp.h"

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
          std::pow(10, -6.0 * static_cast<double>(c) / static_cast<double>(m));
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

void count_flops(benchmark::State& state, double flops) {
  state.counters["GFlop/s"] =
      benchmark::Counter(flops * 1e-9 * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}
double reduction_flops(Index m) {
  return 4.0 / 3 * std::pow(static_cast<double>(m), 3);
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

/// Oscillators (b = 128, |y| = 4) and Poisson (b = 16, |y| = 64).
void bm_gram(benchmark::State& state) {
  const bool poisson = state.range(0) != 0;
  const Index samples = poisson ? 16 : 128, rows = poisson ? 64 : 4;
  const std::vector<Index> sizes = poisson
                                       ? std::vector<Index>{64, 64, 256, 64, 64}
                                       : std::vector<Index>{4, 20, 20, 20, 96};
  std::vector<Batch<double>> data;
  std::vector<GramLayer<double>> layers;
  double features = 0;
  for (std::size_t l = 1; l < sizes.size(); ++l) {
    data.push_back(Batch<double>::Random(samples, sizes[l - 1]));
    data.push_back(Batch<double>::Random(samples * rows, sizes[l]));
    features += static_cast<double>(sizes[l]);
  }
  for (std::size_t l = 1; l < sizes.size(); ++l)
    layers.push_back({.a = data[2 * l - 2].data(),
                      .inputs = sizes[l - 1],
                      .a_stride = samples,
                      .b = data[2 * l - 1].data(),
                      .outputs = sizes[l],
                      .b_stride = samples * rows});
  const Index m = samples * rows;
  Batch<double> g(m, m);
  StructuredGram gram;
  for (auto _ : state) {
    gram.operator()<double>(layers, samples, rows, g);
    benchmark::ClobberMemory();
  }
  count_flops(state, static_cast<double>(m * m) * features);
}
BENCHMARK(bm_gram)
    ->Name("hig/structured_gram")
    ->ArgName("poisson")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);

// ---- an update --------------------------------------------------------------

/// Sizes of an experiment: batch x observations rows, dense layers with their
/// input and output, or the convolutions of the quantum dipole.
struct Size {
  const char* name;
  Index batch, observations;
  std::vector<Index> layers;
  bool convolutions = false;
};

const Size& size_of(Index experiment) {
  static const std::vector<Size> all = {
      {"oscillators", 128, 4, {4, 20, 20, 20, 96}},
      {"quantum", 16, 28, {28, 20, 20, 20, 384}},
      {"quantum_cnn", 16, 28, {28, 384}, true},
      {"poisson", 16, 64, {64, 64, 256, 64, 64}}};
  return all[static_cast<std::size_t>(experiment)];
}

/// One update: network and tape, a solver's Jacobians, everything up to J^T v.
struct Update {
  explicit Update(const Size& size)
      : samples(size.batch),
        per(size.observations),
        outputs(size.layers.back()) {
    const std::vector<Index> hidden(size.layers.begin() + 1,
                                    size.layers.end() - 1);
    const NetworkRecipe recipe =
        size.convolutions ? nn::cnn({.positions = 14,
                                     .channels = 2,
                                     .features = std::vector<Index>(6, 20)})
                          : nn::mlp({.hidden = hidden,
                                     .activation = nn::Activation::tanh,
                                     .init = nn::Init::glorot});
    net = recipe.make<double>(size.layers.front(), outputs);
    theta.resize(net->parameter_count());
    Vector<double> state(net->state_count());
    net->initialize(Rng::root("kernels/hig", 0), theta, state);
    Stream random = Rng::root("kernels/hig", 1).stream();
    const auto noise = [&](Index rows, Index cols) {
      Batch<double> x(rows, cols);
      for (double& v : x.reshaped()) v = random.normal();
      return x;
    };
    g = noise(per, samples);
    // Controls matter less and less: a spectrum over some decades.
    solver = noise(per * outputs, samples);
    for (Index k = 0; k < outputs; ++k)
      solver.middleRows(k * per, per) *= std::pow(
          10, -3.0 * static_cast<double>(k) / static_cast<double>(outputs));
    Batch<double> out(outputs, samples);
    net->forward(theta,
                 state,
                 noise(size.layers.front(), samples),
                 out,
                 tape,
                 work,
                 {.training = true});
    cotangents.resize(outputs, samples * per);
    for (Index i = 0; i < samples; ++i)
      cotangents.middleCols(i * per, per) =
          solver.col(i).reshaped(per, outputs).transpose();
  }

  void rows() {
    layers.clear();
    net->jacobian_rows(theta, tape, cotangents, layers, work);
  }
  void form_gram() {
    std::vector<GramLayer<double>> blocks;
    for (const auto& l : layers) blocks.push_back(gram_layer(l));
    gram.resize(samples * per, samples * per);
    form.operator()<double>(blocks, samples, per, gram);
  }
  void pull_back() {
    column.resize(theta.size());
    VectorOut<double> bar(column);
    net->backward(theta, tape, solver.topRows(outputs), &bar, nullptr, work);
  }

  Index samples, per, outputs;
  std::unique_ptr<Network<double>> net;
  Vector<double> theta, column;
  Tape tape;
  Workspace work;
  Batch<double> g, solver, cotangents, gram;
  std::vector<LayerRows<double>> layers;
  StructuredGram form;
};

void label(benchmark::State& state) {
  state.SetLabel(size_of(state.range(0)).name);
}

/// All of it but the solver.
void bm_update(benchmark::State& state) {
  Update u(size_of(state.range(0)));
  HalfInverseStep<double> step({.power = {.tau = 1e-5}, .rate = 0});
  for (auto _ : state) step(*u.net, u.theta, u.tape, u.solver, u.g, u.work);
  state.counters["MB"] = 1e-6 * static_cast<double>(step.bytes());
  label(state);
}

void bm_update_rows(benchmark::State& state) {
  Update u(size_of(state.range(0)));
  for (auto _ : state) {
    const Workspace::Scope scope(u.work);
    u.rows();
    benchmark::ClobberMemory();
  }
  label(state);
}

void bm_update_gram(benchmark::State& state) {
  Update u(size_of(state.range(0)));
  const Workspace::Scope scope(u.work);
  u.rows();
  double features = 0;
  for (const auto& l : u.layers)
    features +=
        static_cast<double>(std::min(l.positions * l.positions,
                                     l.positions > 1 ? l.inputs + 1 : 1) *
                            l.outputs);
  for (auto _ : state) {
    u.form_gram();
    benchmark::ClobberMemory();
  }
  // One triangle, two flops a product.
  count_flops(state, std::pow(double(u.gram.rows()), 2) * features);
  label(state);
}

void bm_update_power(benchmark::State& state) {
  Update u(size_of(state.range(0)));
  const Workspace::Scope scope(u.work);
  u.rows();
  u.form_gram();
  SpectralPower spectral;
  Vector<double> v(u.gram.rows());
  for (auto _ : state) {
    spectral.factor(u.gram, u.g.reshaped());
    benchmark::DoNotOptimize(spectral.apply({.tau = 1e-5}, v));
  }
  count_flops(state, reduction_flops(u.gram.rows()));
  label(state);
}

void bm_update_pullback(benchmark::State& state) {
  Update u(size_of(state.range(0)));
  for (auto _ : state) {
    u.pull_back();
    benchmark::ClobberMemory();
  }
  label(state);
}

void experiments(benchmark::internal::Benchmark* b) {
  b->ArgName("experiment")->DenseRange(0, 3)->Unit(benchmark::kMillisecond);
}
BENCHMARK(bm_update)->Name("hig/update")->Apply(experiments);
BENCHMARK(bm_update_rows)->Name("hig/update_rows")->Apply(experiments);
BENCHMARK(bm_update_gram)->Name("hig/update_gram")->Apply(experiments);
BENCHMARK(bm_update_power)->Name("hig/update_power")->Apply(experiments);
BENCHMARK(bm_update_pullback)->Name("hig/update_pullback")->Apply(experiments);

}  // namespace
}  // namespace physinv::hig
