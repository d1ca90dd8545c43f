#include "suite/planning/forecast.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "suite/core/decimal.h"
#include "suite/core/median.h"
#include "suite/core/workspace.h"
#include "suite/harness/progress.h"
#include "suite/planning/kinds.h"
#include "suite/planning/split.h"
#include "suite/planning/trials.h"
#include "suite/store/errors.h"

namespace physinv {
namespace {

/// Cases that differ in their seed alone.
using Same = std::tuple<const Method*, Index, Precision, std::vector<Index>>;
Same same_cost(const Case& c) {
  return {c.method, c.info.n, c.info.precision, c.stage_iterations};
}

/// All of the chain's stages, or it is not known.
bool add_published(Cost& cost,
                   const Case& c,
                   const Durations& published,
                   double factor) {
  TimeRange sum;
  std::vector<double> stages;
  for (std::size_t k = 0; k < c.info.stages.size(); ++k) {
    const auto t = published.time(
        c.info.experiment, c.info.method, c.info.stages[k], c.operations(k));
    if (!t) return false;
    stages.push_back(factor * t->seconds);
    sum.seconds += stages.back();
    sum.least += factor * t->least;
    sum.most += factor * t->most;
  }
  cost.seconds = sum.seconds, cost.least = sum.least, cost.most = sum.most;
  cost.stage_seconds = std::move(stages);
  return true;
}

double product(Index a, Index b) {
  return static_cast<double>(a) * static_cast<double>(b);
}

/// Of the options of a stage; all samples if it names none.
Index batch_of(const Stage& stage, Index n) {
  for (const auto& [name, text] : stage.options()) {
    if (name != "batch" && !name.ends_with(".batch")) continue;
    const Index value = decimal<Index>(text).value_or(0);
    if (value > 0) return value;
  }
  return n;
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

/// What a worker process needs for a case, counted without running it.
class Memory {
 public:
  /// `published`: of buffers that stages counted themselves.
  explicit Memory(const Durations& published) : published_(published) {}

  /// Of the program; of data, estimates and curves; of a stage's buffers as
  /// published, else of the tapes of its networks for a batch, their weights
  /// and, for rules that ask for them, Jacobians; and of the networks' tapes
  /// for all n samples, which are evaluated at once.
  double peak_bytes(const Case& c) {
    const Shape shape = c.size.get().shape;
    double most = 0;
    for (std::size_t k = 0; k < c.method->chain.size(); ++k)
      most = std::max(most, stage(c, k));
    return kProgramMemory + most +
           8 * product(c.info.n,
                       shape.unknowns + shape.observations + shape.given);
  }

 private:
  struct Network {
    double weights = 0;    ///< bytes
    double trained = 0;    ///< of tape and scratch, a sample of a batch
    double evaluated = 0;  ///< of a sample where nothing is learnt
  };

  /// By passes of few samples and of twice as many.
  const Network& network(const Case& c, bool predictor) {
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

  double stage(const Case& c, std::size_t k) {
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
    const double points = curve_points(c.stage_iterations[k]);
    const double curve =
        8 * points * static_cast<double>(n) +
        8 * points *
            product(recorded > 0 ? std::min(recorded, n) : n, shape.unknowns);
    constexpr double kCopies = 3;  // of what is written to the disk
    return buffers + all + kCopies * (curve + 8 * product(n, shape.unknowns));
  }

  const Durations& published_;
  std::map<std::pair<const Experiment*, bool>, Network> networks_;
};

}  // namespace

std::vector<Cost> forecast(const std::vector<Case>& cases,
                           const Durations& published,
                           const Trials& trials,
                           double factor) {
  std::map<Kind, std::vector<Trial>> tried;
  for (const auto& [kind, sizes] : kinds_of(cases))
    tried[kind] = known_trials(sizes, trials);
  std::map<Same, Cost> known;  // seeds cost the same
  std::vector<Cost> costs;
  for (const Case& c : cases) {
    const auto [at, is_new] = known.try_emplace(same_cost(c));
    Cost& cost = at->second;
    if (is_new) {
      cost = unmeasured_cost(c);
      const auto& own = tried.at(kind_of(c));
      if (!add_published(cost, c, published, factor) && !own.empty())
        cost = cost_of(c, own);
    }
    costs.push_back(cost);
  }
  return costs;
}

void add_memory(std::vector<Cost>& costs,
                const std::vector<Case>& cases,
                const Durations& published) {
  Memory memory(published);
  std::map<Same, double> known;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto [at, is_new] = known.try_emplace(same_cost(cases[i]));
    if (is_new) at->second = memory.peak_bytes(cases[i]);
    costs[i].memory = std::max(costs[i].memory, at->second);
  }
}

std::string about_text(const std::vector<Case>& cases,
                       int workers,
                       const std::filesystem::path& durations) {
  constexpr double kLittle = 1e10;
  Operations operations;
  double sum = 0;
  for (const Case& c : cases) sum += operations(c);
  if (sum < kLittle) return "";
  try {
    const double seconds = seconds_with(
        forecast(cases, Durations::read(durations), Trials(), machine_factor()),
        workers);
    return seconds >= 0 ? ", about " + duration_text(seconds) : "";
  } catch (const StoreError&) {  // a table that is none; plan says so
    return "";
  }
}

double seconds_with(const std::vector<Cost>& costs, int workers) {
  std::vector<double> seconds;
  for (const Cost& c : costs) {
    if (!std::isfinite(c.seconds)) return c.seconds;
    seconds.push_back(c.seconds);
  }
  return split_longest_first(seconds, static_cast<std::size_t>(workers))
      .longest;
}

std::vector<double> weights_of(const std::vector<Case>& cases,
                               const std::vector<Cost>& costs) {
  Operations operations;
  std::vector<double> rates;
  for (std::size_t i = 0; i < cases.size(); ++i)
    if (const double work = operations(cases[i]);
        work > 0 && std::isfinite(costs[i].seconds))
      rates.push_back(costs[i].seconds / work);
  const double rate = rates.empty() ? 1e-10 : median_high(rates);
  std::vector<double> weights;
  for (std::size_t i = 0; i < cases.size(); ++i)
    weights.push_back(std::isfinite(costs[i].seconds)
                          ? costs[i].seconds
                          : rate * operations(cases[i]));
  return weights;
}

}  // namespace physinv
