#include "optimizers/training.h"

#include <fmt/format.h>

#include "optimizers/training/first_order.h"
#include "optimizers/training/half_inverse_rule.h"
#include "optimizers/training/loop.h"
#include "optimizers/training/predictions.h"
#include "optimizers/training/stage.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

bool first_order(const TrainingOptions& options) {
  return std::holds_alternative<StepOptions>(options.rule);
}

template <class T>
std::unique_ptr<Rule<T>> make_rule(const TrainingOptions& options,
                                   NetworkModel<T>& model,
                                   Threads* threads) {
  if (const auto* step = std::get_if<StepOptions>(&options.rule))
    return std::make_unique<GuardedFirstOrder<T>>(*step, model);
  return std::make_unique<HalfInverseRule<T>>(
      std::get<HalfInverseStepOptions>(options.rule), model, threads);
}

/// From where the stage before left it, if there is one.
template <class T>
void start(NetworkModel<T>& model, const StageRun& run) {
  if (run.previous != nullptr && run.previous->arrays.contains("parameters")) {
    model.load(run.previous->arrays);
  } else {
    model.initialize(run.network_init);
  }
}

template <class T>
Outcome fit(const TrainingOptions& options, StageRun& run) {
  const Shape shape = run.oracle.shape();
  NetworkModel<T> model(
      run.setting.predictor, shape, shape.unknowns, run.threads);
  start(model, run);
  Batches<T> batches(
      run,
      {.size = options.batch, .fresh = options.fresh, .set = options.set},
      drawn_before(run));
  const auto signal = options.signal.make<T>(
      {.run = run,
       .model = model,
       .batches = batches,
       .options = {.gradient_scale = options.gradient_scale,
                   .chunk = options.chunk,
                   .project = options.project}});
  const auto rule = make_rule<T>(options, model, run.threads);
  MetricsRecorder metrics(options.metrics, run);
  Predictions<T> predict(model, run);
  const auto estimate = [&](BatchOut<double> x) {
    predict(x);
    if (!metrics.empty())
      metrics(model.parameters().template cast<double>(), x);
  };

  Outcome out = run_training<T>({.model = model,
                                 .signal = *signal,
                                 .rule = *rule,
                                 .batches = &batches,
                                 .estimate = estimate},
                                run);

  out.x.resize(shape.unknowns, run.oracle.count());
  predict(out.x);
  out.bytes += signal->bytes() + rule->bytes() + batches.bytes();
  out.arrays["mean_loss"] = run.probe.curve().loss.colwise().mean();
  out.arrays["samples_drawn"] =
      Batch<double>::Constant(1, 1, static_cast<double>(batches.drawn()));
  if (!metrics.empty()) out.arrays["metrics"] = metrics.values();
  model.save(out.arrays);
  keep_finite(out.arrays);
  return out;
}

Options in_words(const TrainingOptions& options) {
  Options all = {{"algorithm", options.signal.algorithm},
                 {"batch", fmt::format("{}", options.batch)},
                 {"gradient_scale", fmt::format("{}", options.gradient_scale)},
                 {"fresh", fmt::format("{}", options.fresh)},
                 {"metrics", options.metrics.name}};
  if (options.chunk > 0)
    all.push_back({"chunk", fmt::format("{}", options.chunk)});
  if (options.set > 0) all.push_back({"set", fmt::format("{}", options.set)});
  if (!options.project) all.push_back({"project", "false"});
  const Options rule =
      std::visit([](const auto& o) { return describe(o); }, options.rule);
  all.insert(all.end(), rule.begin(), rule.end());
  return all;
}

double operations(const TrainingOptions& options, const CaseSize& size) {
  const auto samples = static_cast<double>(options.batch);
  const double passes =
      samples * (3 * size.predictor_operations + 3 * size.problem_operations);
  // One reduction of J J^T, or of J where that is smaller.
  const double m = samples * static_cast<double>(size.shape.observations),
               p = size.predictor_operations / 2;
  double reduction = 0;
  if (!first_order(options))
    reduction = p < m ? 2 * m * p * p : 4 * m * m * m / 3;
  return static_cast<double>(size.iterations) * (passes + reduction);
}

Sources sources(const TrainingOptions& options) {
  Sources all;
  options.metrics.add_to(all);
  all.roots.emplace_back(options.signal.source);
  const auto unused = [&](const char* file, const char* header) {
    all.unused.emplace_back(file, header);
  };
  unused("optimizers/training.h", "optimizers/training/solver_loss.h");
  if (const auto* step = std::get_if<StepOptions>(&options.rule)) {
    add_sources(*step, all);
    unused("optimizers/training.h", "optimizers/half_inverse_step.h");
    unused("optimizers/training.cpp",
           "optimizers/training/half_inverse_rule.h");
  } else {
    unused("optimizers/training.h", "optimizers/steps/rule.h");
    unused("optimizers/training.cpp", "optimizers/training/first_order.h");
  }
  return all;
}

}  // namespace

std::shared_ptr<const Stage> train(const TrainingOptions& options) {
  const auto& signal = options.signal;
  return make_stage(
      {.name = options.stage,
       .needs = Needs::forward |
                (first_order(options) ? signal.gradient : signal.jacobians),
       .options = in_words(options),
       .iterations = options.iterations,
       .own_length = options.own_length,
       .operations =
           [options](const CaseSize& size) {
             return operations(options, size);
           },
       .sources = sources(options)},
      [options]<class T>(StageRun& run) { return fit<T>(options, run); });
}

}  // namespace physinv
