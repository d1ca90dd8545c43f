#include "suite/planning/memory.h"

#include <algorithm>
#include <charconv>

#include "suite/core/probe.h"
#include "suite/core/workspace.h"

namespace physinv {
namespace {

/// Code, libraries, registry, and what the allocator keeps.
constexpr double kProgram = 32e6;

double product(Index a, Index b) {
  return static_cast<double>(a) * static_cast<double>(b);
}

/// Of the options of a stage; all samples if it names none.
Index batch_of(const Stage& stage, Index n) {
  for (const auto& [name, text] : stage.options()) {
    if (name != "batch" && !name.ends_with(".batch")) continue;
    Index value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    if (value > 0) return value;
  }
  return n;
}

double points_of(Index iterations) {
  double points = 1;
  for (Index i = 0; i < iterations; i = next_measured(i)) ++points;
  return points;
}

/// Forward; in training backward, too.
double pass_bytes(const Network<float>& network, Index samples, bool training) {
  Tape tape;
  Workspace work;
  Vector<float> parameters(network.parameter_count());
  Vector<float> state(network.state_count()), bar(parameters.size());
  network.initialize(Rng::root("memory", 0), parameters, state);
  const Batch<float> in =
      Batch<float>::Constant(network.inputs(), samples, 0.5F);
  Batch<float> out(network.outputs(), samples);
  network.forward(
      parameters, state, in, out, tape, work, {.training = training});
  VectorOut<float> to(bar);
  if (training) network.backward(parameters, tape, out, &to, nullptr, work);
  return static_cast<double>(tape.bytes() + work.bytes());
}

}  // namespace

const Memory::Network& Memory::network(const Case& c, bool predictor) {
  const auto [at, is_new] =
      networks_.try_emplace({c.experiment.get(), predictor});
  if (!is_new) return at->second;
  const Setting& s = c.experiment->setting;
  const NetworkRole& role = predictor ? s.predictor : s.surrogate;
  if (!role.recipe.make_float) return at->second;
  const Shape shape = c.size.get().shape;
  Index inputs = 0;
  for (const Field f : role.inputs)
    inputs += f == Field::unknowns ? shape.unknowns
              : f == Field::given  ? shape.given
                                   : shape.observations;
  const auto made = role.recipe.make_float(
      inputs, predictor ? shape.unknowns : shape.observations);
  // As many as layers take together; more where that is little, as some
  // networks are evaluated piece by piece.
  constexpr Index kFew = 8, kMore = 256;
  constexpr double kLittle = 64e6;
  const auto sample = [&](Index few, bool training) {
    const double least = pass_bytes(*made, few, training);
    return std::max(0.0, pass_bytes(*made, 2 * few, training) - least) /
           static_cast<double>(few);
  };
  at->second.weights = 4.0 * static_cast<double>(made->parameter_count());
  at->second.trained = sample(kFew, true);
  at->second.evaluated = sample(kFew, false);
  if (at->second.evaluated * kMore < kLittle)
    at->second.evaluated = sample(kMore, false);
  return at->second;
}

double Memory::stage(const Case& c, std::size_t k) {
  const Stage& stage = *c.method->chain[k];
  const Shape shape = c.size.get().shape;
  const Index n = c.info.n, batch = batch_of(stage, n);
  const double wide = c.info.precision == Precision::f64 ? 2 : 1;
  double tapes = 0, all = 0, weights = 0;
  for (const bool predictor : {true, false}) {
    if (!contains(stage.networks(),
                  predictor ? Networks::predictor : Networks::surrogate))
      continue;
    const Network& own = network(c, predictor);
    tapes += wide * own.trained * static_cast<double>(batch);
    all += wide * own.evaluated * static_cast<double>(n);
    weights += wide * own.weights;
  }
  const bool curvature = contains(stage.needs(), Needs::hessian) ||
                         contains(stage.needs(), Needs::jvp);
  double buffers = (curvature ? 2 : 1) * tapes + 6 * weights;
  if (contains(stage.needs(), Needs::jacobian))
    buffers += product(batch, shape.observations) *
               (2 * weights + 8.0 * static_cast<double>(shape.unknowns));
  buffers =
      published_.bytes(c.info.experiment, c.info.method, c.info.stages[k], n)
          .value_or(buffers);
  const Index recorded = c.experiment->setting.recorded;
  const double points = points_of(c.stage_iterations[k]);
  const double curve =
      8 * points * static_cast<double>(n) +
      8 * points *
          product(recorded > 0 ? std::min(recorded, n) : n, shape.unknowns);
  constexpr double kCopies = 3;  // of what goes to the disk
  return buffers + all + kCopies * (curve + 8 * product(n, shape.unknowns));
}

double Memory::of(const Case& c) {
  const Shape shape = c.size.get().shape;
  double most = 0;
  for (std::size_t k = 0; k < c.method->chain.size(); ++k)
    most = std::max(most, stage(c, k));
  return kProgram + most +
         8 * product(c.info.n,
                     shape.unknowns + shape.observations + shape.given);
}

}  // namespace physinv
