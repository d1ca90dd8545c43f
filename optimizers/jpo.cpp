#include "optimizers/jpo.h"

#include <cmath>
#include <limits>
#include <utility>

#include "optimizers/stage.h"
#include "optimizers/steps/clip_percentile.h"
#include "optimizers/steps/rule_check.h"
#include "optimizers/training/first_order.h"
#include "optimizers/training/loop.h"
#include "optimizers/training/output_map.h"
#include "suite/core/archive.h"
#include "suite/core/check.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

/// The best estimate each example had at any time.
template <class T>
class BestSoFar {
 public:
  /// Of nothing seen yet, the start is best.
  explicit BestSoFar(Batch<T> start)
      : x_(std::move(start)),
        loss_(Vector<T>::Constant(x_.cols(),
                                  std::numeric_limits<T>::infinity())) {}

  /// Losses are compared in the precision of training. False if none is finite.
  bool offer(const Batch<T>& x, const Vector<double>& losses) {
    bool finite = false;
    for (Index i = 0; i < losses.size(); ++i) {
      finite = finite || std::isfinite(losses(i));
      const T loss = static_cast<T>(losses(i));
      if (!(loss < loss_(i))) continue;  // NaN is never better
      loss_(i) = loss;
      x_.col(i) = x.col(i);
    }
    return finite;
  }

  const Batch<T>& x() const { return x_; }
  void serialize(Archive& archive) { archive(x_, loss_); }

 private:
  Batch<T> x_;
  Vector<T> loss_;
};

/// The signal: losses and clipped gradients of the case's own problems, all of
/// them at every evaluation.
template <class T>
class JointLoss final : public Signal<T> {
 public:
  JointLoss(double clip, StageRun& run, NetworkModel<T>& model)
      : probe_(run.probe),
        oracle_(run.oracle),
        model_(model),
        map_(output_map<T>(run.setting, oracle_)),
        clip_(clip),
        observations_(oracle_.observations().template cast<T>()),
        x_(oracle_.start().template cast<T>()),
        gradient_(x_),
        loss_(oracle_.count()),
        best_(x_) {}

  void warm_up() override {
    model_.warm_up();
    oracle_.template warm_up<T>();
  }

  /// The last evaluation needs no gradient.
  bool evaluate(bool last) override {
    (*map_)(model_.forward(), observations_, x_);
    if (last) {
      oracle_.evaluate<T>(oracle_.all(), x_, loss_);
    } else {
      oracle_.evaluate<T>(oracle_.all(), x_, loss_, gradient_);
    }
    probe_.trace(loss_.data(),
                 sizeof(double) * static_cast<std::size_t>(loss_.size()));
    return best_.offer(x_, loss_);
  }

  /// By the estimates of the last evaluation.
  Vector<T>& gradient() override {
    clip_.template operator()<T>(gradient_);
    map_->pull_back(gradient_);
    return model_.backward(gradient_);
  }

  /// The next evaluation makes the rest.
  void serialize(Archive& archive) override { archive(best_); }

  const Batch<T>& x() const { return x_; }
  const Batch<T>& best() const { return best_.x(); }

 private:
  Probe& probe_;
  Oracle& oracle_;
  NetworkModel<T>& model_;
  std::unique_ptr<OutputMap<T>> map_;
  ClipPercentile clip_;
  Batch<T> observations_, x_, gradient_;
  Vector<double> loss_;
  BestSoFar<T> best_;
};

template <class T>
Outcome fit(const JpoOptions& options, StageRun& run) {
  Oracle& oracle = run.oracle;
  const NetworkRole& role = run.setting.predictor;
  NetworkModel<T> model(
      role, oracle.shape(), oracle.shape().unknowns, run.threads);
  model.initialize(run.network_init);
  model.bind(assemble<T>(
      role.inputs, oracle.start(), oracle.given(), oracle.observations()));

  JointLoss<T> signal(options.clip, run, model);
  FirstOrder<T> rule(options.step, model);
  Outcome out = run_training<T>(
      {.model = model,
       .signal = signal,
       .rule = rule,
       .batches = nullptr,
       .estimate =
           [&](BatchOut<double> x) { x = signal.x().template cast<double>(); }},
      run);

  out.x = signal.best().template cast<double>();
  out.evaluations = out.iterations.array() + 1;
  out.arrays["weight_change"] = model.change_per_tensor(run.network_init);
  return out;
}

}  // namespace

std::shared_ptr<const Stage> jpo_fit(const JpoOptions& options) {
  check_rule<double>(options.step);
  SUITE_CHECK(0 <= options.clip && options.clip <= 1,
              "clip is a quantile and must be in [0, 1]");
  SUITE_CHECK(options.iterations >= 0, "iterations must not be negative");
  const auto operations = [](const CaseSize& size) {
    return static_cast<double>(size.n * size.iterations) *
           (3 * size.predictor_operations + 3 * size.problem_operations);
  };
  Sources sources;
  add_sources(options.step, sources);
  return make_stage(
      {.name = "fit",
       .needs = Needs::forward | Needs::vjp,
       .options = describe(options),
       .iterations = options.iterations,
       .operations = operations,
       .sources = sources},
      [options]<class T>(StageRun& run) { return fit<T>(options, run); });
}

}  // namespace physinv
