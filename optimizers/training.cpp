#include "optimizers/training.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimizers/minibatch.h"
#include "optimizers/network_model.h"

namespace physinv {
namespace {

/// Arrays of records hold finite numbers only.
double finite(double value) {
  constexpr double kMost = std::numeric_limits<double>::max();
  return std::isfinite(value) ? value : kMost;
}

Batch<double> row(const std::vector<double>& values) {
  return Eigen::Map<const Batch<double>>(
      values.data(), 1, static_cast<Index>(values.size()));
}

Index drawn_before(const StageRun& run) {
  if (run.previous == nullptr) return 0;
  const auto found = run.previous->arrays.find("samples_drawn");
  return found == run.previous->arrays.end()
             ? 0
             : static_cast<Index>(found->second(0, 0));
}

template <class T>
class Training {
 public:
  Training(const TrainingOptions& options, StageRun& run)
      : options_(options),
        run_(run),
        oracle_(run.oracle),
        model_(run.setting.predictor,
               oracle_.shape(),
               oracle_.shape().unknowns,
               run.threads),
        batch_(run, options.batch, options.fresh, drawn_before(run)),
        factor_(static_cast<T>(options.gradient_scale /
                               static_cast<double>(batch_.size()))),
        scale_(static_cast<T>(run.setting.output_scale)),
        start_(oracle_.start().col(0).template cast<T>()),
        update_(options.rule),
        metrics_(static_cast<Index>(options.metrics.rows.size()), 0) {
    if (run.previous != nullptr &&
        run.previous->arrays.contains("parameters")) {
      model_.load(run.previous->arrays);
    } else {
      model_.initialize(run.network_init);
    }
  }

  Outcome run() {
    Probe& probe = run_.probe;
    const Batch<T> query = assemble<T>(run_.setting.predictor.inputs,
                                       oracle_.start(),
                                       oracle_.given(),
                                       oracle_.observations());
    Batch<T> output(oracle_.shape().unknowns, oracle_.count());
    const Batch<double> start = oracle_.start();
    const auto estimate = [&](BatchOut<double> x) {
      model_.predict(query, output);
      x = start + run_.setting.output_scale * output.template cast<double>();
      measure(x);
    };
    probe.begin_warmup();
    probe.begin();
    while (probe.proceed(estimate)) {
      batch_.next();
      before_ = model_.parameters();
      step();
      losses_.push_back(finite(batch_.mean_loss()));
      probe.trace(before_.data(),
                  sizeof(T) * static_cast<std::size_t>(before_.size()));
      if (model_.parameters().allFinite()) continue;
      model_.parameters() = before_;
      probe.stop(), diverged_ = true;
    }
    Outcome out = outcome();
    out.x.resizeLike(start);
    model_.predict(query, output);
    out.x = start + run_.setting.output_scale * output.template cast<double>();
    return out;
  }

 private:
  void step();

  /// The metrics at this point of the curve.
  void measure(BatchIn<double> x) {
    if (metrics_.rows() == 0) return;
    const auto problem = oracle_.recipe().make<double>();
    Batch<double> y(oracle_.shape().observations, oracle_.count());
    Workspace work(run_.threads);
    problem->forward(x, oracle_.given(), y, work);
    const Vector<double> parameters =
        model_.parameters().template cast<double>();
    metrics_.conservativeResize(Eigen::NoChange, metrics_.cols() + 1);
    Vector<double> values(metrics_.rows());
    options_.metrics.evaluate(
        {run_.probe.iteration(), parameters, x, y, oracle_}, values);
    metrics_.rightCols(1) = values.unaryExpr(&finite);
  }

  Outcome outcome() {
    Outcome out;
    out.iterations.setConstant(oracle_.count(),
                               static_cast<double>(run_.probe.iteration()));
    out.arrays["batch_loss"] = row(losses_);
    out.arrays["mean_loss"] =
        run_.probe.curve().loss.colwise().mean().unaryExpr(&finite);
    out.arrays["samples_drawn"] =
        Batch<double>::Constant(1, 1, static_cast<double>(batch_.drawn()));
    if (metrics_.rows() > 0) out.arrays["metrics"] = metrics_;
    if (diverged_) {
      out.stop = Stop::diverged;
      out.message =
          fmt::format("update {} makes a parameter infinite; it was not taken",
                      run_.probe.iteration());
    }
    model_.save(out.arrays);
    for (auto& [name, array] : out.arrays) array = array.unaryExpr(&finite);
    out.bytes = model_.bytes() + batch_.bytes();
    oracle_.add(model_.counts());
    oracle_.add(batch_.counts());
    return out;
  }

  const TrainingOptions& options_;
  StageRun& run_;
  Oracle& oracle_;
  NetworkModel<T> model_;
  Minibatch<T> batch_;
  T factor_, scale_;
  Vector<T> start_;
  UpdateStep<T> update_;
  Batch<T> x_, x_bar_;
  Vector<T> before_;  ///< parameters, should the update spoil them
  Batch<double> metrics_;
  std::vector<double> losses_;
  bool diverged_ = false;
};

template <class T>
void Training<T>::step() {
  const Batch<T>& output = model_.forward(batch_.input());
  x_ = scale_ * output;
  x_.colwise() += start_;
  x_bar_.resizeLike(x_);
  batch_.gradient(x_, factor_, x_bar_);
  if (scale_ != T(1)) x_bar_ *= scale_;
  update_(model_.parameters(), model_.backward(x_bar_));
  model_.update_state();
}

class TrainingStage final : public Stage {
 public:
  explicit TrainingStage(const TrainingOptions& options) : options_(options) {}

  std::string name() const override { return options_.stage; }
  Needs needs() const override { return Needs::forward | Needs::vjp; }
  Options options() const override {
    Options all = {
        {"algorithm", "training"},
        {"batch", fmt::format("{}", options_.batch)},
        {"gradient_scale", fmt::format("{}", options_.gradient_scale)},
        {"fresh", fmt::format("{}", options_.fresh)},
        {"metrics", options_.metrics.name}};
    for (auto& option : describe(options_.rule)) all.push_back(option);
    return all;
  }
  Index default_iterations() const override { return options_.iterations; }
  bool has_precision() const override { return true; }
  double operations(const CaseSize& size) const override {
    return static_cast<double>(options_.batch * size.iterations) *
           (3 * size.predictor_operations + 3 * size.problem_operations);
  }
  Outcome run(StageRun& run) const override {
    if (run.precision == Precision::f32)
      return Training<float>(options_, run).run();
    return Training<double>(options_, run).run();
  }

 private:
  TrainingOptions options_;
};

}  // namespace

std::shared_ptr<const Stage> train(const TrainingOptions& options) {
  return std::make_shared<TrainingStage>(options);
}

}  // namespace physinv
