#include "optimizers/training.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "optimizers/minibatch.h"
#include "optimizers/network_model.h"

namespace physinv {
namespace {

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
        level_start_((start_.array() == start_(0)).all()),
        metrics_(options.metrics, run) {
    if (const auto* rule = std::get_if<StepOptions>(&options.rule)) {
      update_.emplace(*rule);
    } else {
      half_inverse_.emplace(std::get<HalfInverseStepOptions>(options.rule),
                            run.threads);
    }
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
    const Batch<double> start = oracle_.start();  // makes a problem
    const auto predict = [&](BatchOut<double> x) {
      model_.predict(query, output);
      x = start + run_.setting.output_scale * output.template cast<double>();
    };
    const auto estimate = [&](BatchOut<double> x) {
      predict(x);
      if (!metrics_.empty())
        metrics_(model_.parameters().template cast<double>(), x);
    };
    probe.begin_warmup();
    probe.begin();
    while (probe.proceed(estimate)) {
      next_batch();
      diverged_ = !step();
      if (diverged_) probe.stop();
      losses_.push_back(batch_.mean_loss());
      const auto& theta = model_.parameters();
      probe.trace(theta.data(),
                  sizeof(T) * static_cast<std::size_t>(theta.size()));
    }
    Outcome out = outcome();
    out.x.resizeLike(start);
    predict(out.x);
    return out;
  }

 private:
  /// Samples that are new for every update are drawn off the clock.
  void next_batch() {
    if (options_.fresh) run_.probe.pause();
    batch_.next();
    if (options_.fresh) run_.probe.resume();
  }

  /// x of these inputs, in training mode.
  void forward(BatchIn<T> input) {
    x_ = scale_ * model_.forward(input);
    if (level_start_) {
      x_.array() += start_(0);  // whole registers, however short a column is
    } else {
      x_.colwise() += start_;
    }
    model_.update_state();
  }

  /// Of the batch, by the parameters, in memory that may be written.
  Vector<T>& gradient();

  /// False, and nothing changed, if the update is not finite.
  bool step();

  Outcome outcome() {
    Outcome out;
    out.iterations.setConstant(oracle_.count(),
                               static_cast<double>(run_.probe.iteration()));
    const Index numbers =
        x_.size() + x_bar_.size() + jacobian_.size() + sum_.size() +
        (update_ ? update_->numbers_per_parameter() * model_.parameters().size()
                 : 0);
    out.bytes = model_.bytes() + batch_.bytes() +
                static_cast<std::size_t>(numbers) * sizeof(T);
    out.arrays["batch_loss"] = row(losses_);
    out.arrays["mean_loss"] = run_.probe.curve().loss.colwise().mean();
    out.arrays["samples_drawn"] =
        Batch<double>::Constant(1, 1, static_cast<double>(batch_.drawn()));
    if (!metrics_.empty()) out.arrays["metrics"] = metrics_.values();
    if (half_inverse_) add_spectra(out);
    if (diverged_) {
      out.stop = Stop::diverged;
      out.message =
          fmt::format("update {} makes a parameter infinite; it was not taken",
                      run_.probe.iteration());
    }
    model_.save(out.arrays);
    keep_finite(out.arrays);
    oracle_.add(model_.counts());
    oracle_.add(batch_.counts());
    return out;
  }

  void add_spectra(Outcome& out) {
    out.arrays["kept"] = row(kept_);
    out.arrays["smallest"] = row(smallest_);
    out.arrays["path"] = row(path_);
    out.arrays["unproven"] = Batch<double>::Constant(1, 1, unproven_);
    out.bytes += half_inverse_->bytes();
  }

  const TrainingOptions& options_;
  StageRun& run_;
  Oracle& oracle_;
  NetworkModel<T> model_;
  Minibatch<T> batch_;
  T factor_, scale_;
  Vector<T> start_;
  bool level_start_;  ///< all of its numbers are equal
  std::optional<UpdateStep<T>> update_;
  std::optional<HalfInverseStep<T>> half_inverse_;
  Batch<T> jacobian_;
  std::vector<double> kept_, smallest_, path_;
  Batch<T> x_, x_bar_;
  Vector<T> sum_;
  MetricsRecorder metrics_;
  std::vector<double> losses_;
  double unproven_ = 0;
  bool diverged_ = false;
};

template <class T>
Vector<T>& Training<T>::gradient() {
  const Index n = batch_.size();
  const Index most = options_.chunk > 0 ? std::min(options_.chunk, n) : n;
  const auto part = [&](BatchIn<T> input, Index first) -> Vector<T>& {
    forward(input);
    x_bar_.resizeLike(x_);
    batch_.gradient(x_, factor_, x_bar_, first);
    if (scale_ != T(1)) x_bar_ *= scale_;
    return model_.backward(x_bar_);
  };
  if (most == n) return part(batch_.input(), 0);
  SUITE_CHECK(model_.state().size() == 0, "batch statistics need the batch");
  sum_.setZero(model_.parameters().size());
  for (Index first = 0; first < n; first += most) {
    const Index count = std::min(most, n - first);
    sum_ += part(batch_.input().middleCols(first, count), first);
  }
  return sum_;
}

template <class T>
bool Training<T>::step() {
  if (update_) {
    // The gradient's memory takes the new parameters, so that the old ones are
    // there should these be spoilt.
    Vector<T>& next = gradient();
    (*update_)(model_.parameters(), next, next);
    // As allFinite(), but in registers.
    if ((T(0) * next).sum() != T(0)) return false;
    model_.parameters().swap(next);
    return true;
  }
  forward(batch_.input());
  jacobian_.resize(x_.rows() * oracle_.shape().observations, x_.cols());
  batch_.jacobian(x_, factor_, options_.project, jacobian_);
  if (scale_ != T(1)) jacobian_ *= scale_;
  const bool taken = (*half_inverse_)(model_.network(),
                                      model_.parameters(),
                                      model_.tape(),
                                      jacobian_,
                                      batch_.y_bar(),
                                      model_.workspace());
  const auto& report = half_inverse_->report();
  kept_.push_back(static_cast<double>(report.kept));
  smallest_.push_back(report.s_max > 0 ? report.smallest_kept / report.s_max
                                       : 0);
  path_.push_back(static_cast<double>(report.path));
  unproven_ += !report.proven;
  return taken;
}

class TrainingStage final : public Stage {
 public:
  explicit TrainingStage(const TrainingOptions& options) : options_(options) {}

  std::string name() const override { return options_.stage; }
  Needs needs() const override {
    return Needs::forward | (std::holds_alternative<StepOptions>(options_.rule)
                                 ? Needs::vjp
                                 : Needs::jacobian);
  }
  Options options() const override {
    Options all = {
        {"algorithm", "training"},
        {"batch", fmt::format("{}", options_.batch)},
        {"gradient_scale", fmt::format("{}", options_.gradient_scale)},
        {"fresh", fmt::format("{}", options_.fresh)},
        {"metrics", options_.metrics.name}};
    if (options_.chunk > 0)
      all.push_back({"chunk", fmt::format("{}", options_.chunk)});
    if (!options_.project) all.push_back({"project", "false"});
    const Options rule =
        std::visit([](const auto& o) { return describe(o); }, options_.rule);
    all.insert(all.end(), rule.begin(), rule.end());
    return all;
  }
  Index default_iterations() const override { return options_.iterations; }
  bool takes_row_iterations() const override { return !options_.own_length; }
  bool has_precision() const override { return true; }
  double operations(const CaseSize& size) const override {
    const auto samples = static_cast<double>(options_.batch);
    const double passes =
        samples * (3 * size.predictor_operations + 3 * size.problem_operations);
    // One reduction of J J^T, or of J where that is smaller.
    const double m = samples * static_cast<double>(size.shape.observations),
                 p = size.predictor_operations / 2;
    double reduction = 0;
    if (!std::holds_alternative<StepOptions>(options_.rule))
      reduction = p < m ? 2 * m * p * p : 4 * m * m * m / 3;
    return static_cast<double>(size.iterations) * (passes + reduction);
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
