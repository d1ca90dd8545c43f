// Timings of the classical optimizers without a physics problem; then an update
// by the half-inverse and its parts, at the experiments' sizes.
#include "optimizers/half_inverse/kernels.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "optimizers/bfgs.h"
#include "optimizers/drive.h"
#include "optimizers/half_inverse/half_inverse_step.h"
#include "optimizers/steps/bfgs_update.h"
#include "suite/core/math.h"
#include "suite/nn/cnn.h"
#include "suite/nn/mlp.h"

namespace physinv {
namespace {

using benchmark::State;

void rosenbrock(std::span<const Index>,
                BatchIn<double> x,
                VectorOut<double> loss,
                BatchOut<double> gradient) {
  for (Index i = 0; i < x.cols(); ++i) {
    const double a = 1 - x(0, i), b = x(1, i) - x(0, i) * x(0, i);
    loss(i) = a * a + 100 * b * b;
    gradient(0, i) = -2 * a - 400 * x(0, i) * b;
    gradient(1, i) = 200 * b;
  }
}

void bfgs_update(State& state) {
  const Index d = state.range(0);
  std::vector<double> h(static_cast<std::size_t>(d * d));
  Vector<double> s(d), y(d), scratch(d);
  for (Index i = 0; i < d; ++i) {
    s(i) = math::sin(0.7 * static_cast<double>(i) + 1);
    y(i) = (1 + 0.5 * math::cos(static_cast<double>(i))) * s(i);
  }
  dense::set_identity(d, h.data());
  measure(state, [&] {
    dense::bfgs_update(d, s.data(), y.data(), h.data(), scratch.data());
  });
  state.SetItemsProcessed(state.iterations());
}

/// Whole runs of 128 problems, as a table of billiards needs them.
void bfgs_batch(State& state) {
  const Index n = 128;
  Batch<double> x0(2, n);
  for (Index i = 0; i < n; ++i) {
    x0(0, i) = 2 * math::sin(static_cast<double>(i));
    x0(1, i) = 2 * math::cos(1.7 * static_cast<double>(i));
  }
  Bfgs solver;
  for (auto _ : state) drive(solver, rosenbrock, x0);
  double evaluations = 0;
  for (const Index e : solver.evaluations())
    evaluations += static_cast<double>(e);
  state.counters["evaluations"] = evaluations;
  state.counters["rounds"] = static_cast<double>(solver.rounds());
  state.SetItemsProcessed(state.iterations() * n);
}

const bool kAdded =
    add_kernels({{"optimizers/bfgs_update", {{2}, {16}, {128}}, bfgs_update}},
                [](auto& kernel) { kernel.ArgName("d"); }) &&
    add_kernels({{"optimizers/bfgs_rosenbrock_128", {}, bfgs_batch}});

}  // namespace
}  // namespace physinv

namespace physinv::hig {
namespace {

using benchmark::State;

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
      solver.middleRows(k * per, per) *= math::pow(
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
    by_rows(*net).jacobian_rows(theta, tape, cotangents, layers, work);
  }
  void form_gram() {
    gram.resize(samples * per, samples * per);
    form.operator()<double>(layers, samples, per, gram);
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

void label(State& state) { state.SetLabel(size_of(state.range(0)).name); }

/// All of it but the solver.
void update(State& state) {
  Update u(size_of(state.range(0)));
  HalfInverseStep<double> step({.power = {.tau = 1e-5}, .rate = 0});
  for (auto _ : state) step(*u.net, u.theta, u.tape, u.solver, u.g, u.work);
  state.counters["MB"] = 1e-6 * static_cast<double>(step.bytes());
  label(state);
}

void update_rows(State& state) {
  Update u(size_of(state.range(0)));
  measure(state, [&] {
    const Workspace::Scope scope(u.work);
    u.rows();
  });
  label(state);
}

void update_gram(State& state) {
  Update u(size_of(state.range(0)));
  const Workspace::Scope scope(u.work);
  u.rows();
  double features = 0;
  for (const auto& l : u.layers)
    features +=
        static_cast<double>(std::min(l.positions * l.positions,
                                     l.positions > 1 ? l.inputs + 1 : 1) *
                            l.outputs);
  measure(state, [&] { u.form_gram(); });
  // One triangle, two flops a product.
  count_flops(state, double(u.gram.rows() * u.gram.rows()) * features);
  label(state);
}

void update_power(State& state) {
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

void update_pullback(State& state) {
  Update u(size_of(state.range(0)));
  measure(state, [&] { u.pull_back(); });
  label(state);
}

const std::vector<std::vector<std::int64_t>> kExperiments = {
    {0}, {1}, {2}, {3}};

const bool kAdded =
    add_kernels({{"hig/update", kExperiments, update},
                 {"hig/update_rows", kExperiments, update_rows},
                 {"hig/update_gram", kExperiments, update_gram},
                 {"hig/update_power", kExperiments, update_power},
                 {"hig/update_pullback", kExperiments, update_pullback}},
                in_milliseconds("experiment"));

}  // namespace
}  // namespace physinv::hig
