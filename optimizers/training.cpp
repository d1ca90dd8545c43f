#include "optimizers/training.h"

#include <array>
#include <cmath>
#include <type_traits>

#include "optimizers/stage.h"
#include "optimizers/steps/rule_check.h"
#include "optimizers/training/adahessian_rule.h"
#include "optimizers/training/first_order.h"
#include "optimizers/training/half_inverse_rule.h"
#include "optimizers/training/hessian_free_rule.h"
#include "optimizers/training/loop.h"
#include "optimizers/training/predictions.h"
#include "suite/core/check.h"
#include "suite/core/option_check.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

template <class Options>
bool has_rule(const TrainingOptions& options) {
  return std::holds_alternative<Options>(options.rule);
}

void check(const StepOptions& o) { check_rule<double>(o); }

void check(const HalfInverseStepOptions& o) {
  check_numbers<double>({{"kappa", o.power.kappa},
                         {"tau", o.power.tau},
                         {"beta", o.power.beta},
                         {"rate", o.rate}});
  SUITE_CHECK(std::abs(o.power.kappa) <= 1, "kappa must be in [-1, 1]");
  SUITE_CHECK(o.power.tau >= 0, "tau must not be negative");
  SUITE_CHECK(
      o.numerics.tolerance >= 0 && o.numerics.gram_noise >= 0 &&
          o.numerics.largest_jacobian >= 0,
      "tolerance, gram_noise and largest_jacobian must not be negative");
}

void check(const AdaHessianOptions& o) {
  check_numbers<double>({{"rate", o.rate}, {"power", o.power}, {"eps", o.eps}});
  SUITE_CHECK(o.rate >= 0 && o.power >= 0 && o.eps >= 0,
              "rate, power and eps must not be negative");
  SUITE_CHECK(0 <= o.beta1 && o.beta1 < 1 && 0 <= o.beta2 && o.beta2 < 1,
              "betas must be in [0, 1)");
}

void check(const HessianFreeOptions& o) {
  check_numbers<double>(
      {{"rate", o.rate}, {"damping", o.damping}, {"warm", o.warm}});
  SUITE_CHECK(o.damping >= 0, "damping must not be negative");
  SUITE_CHECK(o.solver.iterations > 0 && o.solver.progress >= 0 &&
                  o.solver.residual >= 0,
              "conjugate gradients need at least one iteration, and their "
              "tolerances must not be negative");
}

void check(const TrainingOptions& o) {
  SUITE_CHECK(o.batch > 0, "batch must be positive");
  SUITE_CHECK(o.chunk >= 0 && o.set >= 0 && o.iterations >= 0,
              "chunk, set and iterations must not be negative");
  check_numbers<double>({{"gradient_scale", o.gradient_scale}});
  std::visit([](const auto& rule) { check(rule); }, o.rule);
}

template <class T>
std::unique_ptr<Rule<T>> make_rule(const TrainingOptions& options,
                                   NetworkModel<T>& model,
                                   const StageRun& run) {
  const auto make = [&](const auto& o) -> std::unique_ptr<Rule<T>> {
    using Options = std::remove_cvref_t<decltype(o)>;
    if constexpr (std::is_same_v<Options, StepOptions>) {
      return std::make_unique<GuardedFirstOrder<T>>(o, model);
    } else if constexpr (std::is_same_v<Options, AdaHessianOptions>) {
      return std::make_unique<AdaHessianRule<T>>(o, model, run.method);
    } else if constexpr (std::is_same_v<Options, HessianFreeOptions>) {
      return std::make_unique<HessianFreeRule<T>>(o, model);
    } else {
      return std::make_unique<HalfInverseRule<T>>(o, model, run.threads);
    }
  };
  return std::visit(make, options.rule);
}

/// What a rule asks of the signal, and that of the problem.
Needs needs(const TrainingOptions& options) {
  const SignalRecipe& signal = options.signal;
  const auto products = [&](const std::optional<Needs>& asked) {
    SUITE_CHECK(asked.has_value(),
                "the signal " + signal.algorithm +
                    " has no products with second derivatives; use "
                    "solver_loss() with rules of curvature");
    return *asked | signal.gradient;
  };
  if (has_rule<StepOptions>(options)) return signal.gradient;
  if (has_rule<HalfInverseStepOptions>(options)) return signal.jacobians;
  SUITE_CHECK(options.chunk == 0,
              "rules of curvature need the batch in one chunk");
  return products(has_rule<AdaHessianOptions>(options) ? signal.hessian
                                                       : signal.gauss_newton);
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
                   .project = options.project,
                   .late = options.late}});
  const auto rule = make_rule<T>(options, model, run);
  MetricsRecorder metrics(options.metrics, run);
  Predictions<T> predict(model, run);
  const auto measured = [&](BatchIn<double> x, BatchIn<double> y) {
    if (!metrics.empty())
      metrics(model.parameters().template cast<double>(), x, y);
  };

  Outcome out =
      run_training<T>({.model = model,
                       .signal = *signal,
                       .rule = *rule,
                       .batches = &batches,
                       .estimate = [&](BatchOut<double> x) { predict(x); },
                       .measured = measured,
                       .serialize = [&](Archive& a) { a(metrics); }},
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

double operations(const TrainingOptions& options, const CaseSize& size) {
  const auto samples = static_cast<double>(options.batch);
  const double passes =
      samples * (3 * size.predictor_operations + 3 * size.problem_operations);
  double more = 0;
  if (has_rule<HalfInverseStepOptions>(options)) {
    // One reduction of J J^T, or of J where that is smaller.
    const double m = samples * static_cast<double>(size.shape.observations),
                 p = size.predictor_operations / 2;
    more = p < m ? 2 * m * p * p : 4 * m * m * m / 3;
  } else if (has_rule<AdaHessianOptions>(options)) {
    more = 3 * passes;  // forward mode, and its reverse
  } else if (const auto* o = std::get_if<HessianFreeOptions>(&options.rule)) {
    more = 1.5 * passes * static_cast<double>(o->solver.iterations);
  }
  return static_cast<double>(size.iterations) * (passes + more);
}

/// Where options and class of a rule are, in the order of the variant.
constexpr std::array<std::array<const char*, 2>, 4> kRules = {
    {{"optimizers/steps/rule.h", "optimizers/training/first_order.h"},
     {"optimizers/half_inverse/options.h",
      "optimizers/training/half_inverse_rule.h"},
     {"optimizers/steps/adahessian.h", "optimizers/training/adahessian_rule.h"},
     {"optimizers/training/hessian_free.h",
      "optimizers/training/hessian_free_rule.h"}}};

Sources sources(const TrainingOptions& options) {
  Sources all;
  options.metrics.add_to(all);
  if (options.late.of) all.roots.emplace_back(options.late.source);
  all.roots.emplace_back(options.signal.source);
  const auto unused = [&](const char* file, const char* header) {
    all.unused.emplace_back(file, header);
  };
  unused("optimizers/training.h", "optimizers/training/solver_loss.h");
  if (const auto* step = std::get_if<StepOptions>(&options.rule))
    add_sources(*step, all);
  else
    unused("optimizers/training.cpp", "optimizers/steps/rule_check.h");
  for (std::size_t i = 0; i < kRules.size(); ++i) {
    if (i == options.rule.index()) continue;
    unused("optimizers/training.h", kRules[i][0]);
    unused("optimizers/training.cpp", kRules[i][1]);
  }
  return all;
}

}  // namespace

std::shared_ptr<const Stage> train(const TrainingOptions& options) {
  check(options);
  const auto shared = std::make_shared<const TrainingOptions>(options);
  return make_stage(
      {.name = options.stage,
       .needs = Needs::forward | needs(options),
       .options = [shared] { return describe(*shared); },
       .iterations = options.iterations,
       .own_length = options.own_length,
       .operations =
           [shared](const CaseSize& size) { return operations(*shared, size); },
       .sources = [shared] { return sources(*shared); }},
      [shared]<class T>(StageRun& run) { return fit<T>(*shared, run); });
}

}  // namespace physinv
