#include "optimizers/jpo.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "optimizers/network_model.h"
#include "optimizers/steps/clip_percentile.h"

namespace physinv {
namespace {

template <class T>
class JpoRun {
 public:
  JpoRun(const JpoOptions& options, StageRun& run)
      : run_(run),
        oracle_(run.oracle),
        model_(run.setting.predictor,
               oracle_.shape(),
               oracle_.shape().unknowns,
               run.threads),
        clip_(options.clip),
        update_(options.step),
        start_(oracle_.start().template cast<T>()),
        scale_(static_cast<T>(run.setting.output_scale)),
        x_(start_),
        gradient_(start_),
        best_x_(start_),
        loss_(oracle_.count()),
        best_(Vector<T>::Constant(oracle_.count(), kWorst)) {
    model_.initialize(run.network_init);
    model_.bind(assemble<T>(run.setting.predictor.inputs,
                            oracle_.start(),
                            oracle_.given(),
                            oracle_.observations()));
  }

  Outcome run() {
    Probe& probe = run_.probe;
    probe.begin_warmup();
    model_.warm_up();
    oracle_.template warm_up<T>();
    probe.begin();
    estimate();
    while (probe.proceed(
        [&](BatchOut<double> x) { x = x_.template cast<double>(); })) {
      step();
      estimate();
    }
    return outcome();
  }

 private:
  /// x, losses, gradients (if a step follows), and the best so far.
  void estimate() {
    x_.noalias() = start_ + scale_ * model_.forward();
    const bool last = run_.probe.iteration() == run_.probe.iterations();
    if (last) {
      oracle_.evaluate<T>(oracle_.all(), x_, loss_);
    } else {
      oracle_.evaluate<T>(oracle_.all(), x_, loss_, gradient_);
    }
    bool finite = false;
    for (Index i = 0; i < loss_.size(); ++i) {
      finite = finite || std::isfinite(loss_(i));
      const T loss = static_cast<T>(loss_(i));
      if (!(loss < best_(i))) continue;  // NaN is never better
      best_(i) = loss;
      best_x_.col(i) = x_.col(i);
    }
    if (!finite) run_.probe.stop(), diverged_ = true;
    run_.probe.trace(loss_.data(), sizeof(double) * bytes_of(loss_));
  }

  void step() {
    clip_.template operator()<T>(gradient_);
    // d x / d output = scale; Adam's step hardly feels it, but eps does.
    if (scale_ != T(1)) gradient_ *= scale_;
    update_(model_.parameters(), model_.backward(gradient_));
    run_.probe.trace(model_.parameters().data(),
                     sizeof(T) * bytes_of(model_.parameters()));
  }

  template <class V>
  static std::size_t bytes_of(const V& v) {
    return static_cast<std::size_t>(v.size());
  }

  Outcome outcome() {
    Outcome out;
    out.x = best_x_.template cast<double>();
    const auto iterations = static_cast<double>(run_.probe.iteration());
    out.iterations.setConstant(oracle_.count(), iterations);
    out.evaluations.setConstant(oracle_.count(), iterations + 1);
    out.arrays["weight_change"] = model_.change_per_tensor(run_.network_init);
    out.bytes = model_.bytes();
    if (diverged_) {
      out.stop = Stop::diverged;
      out.message = fmt::format("no finite loss after iteration {}",
                                run_.probe.iteration());
    }
    oracle_.add(model_.counts());
    return out;
  }

  static constexpr T kWorst = std::numeric_limits<T>::infinity();

  StageRun& run_;
  Oracle& oracle_;
  NetworkModel<T> model_;
  ClipPercentile clip_;
  UpdateStep<T> update_;
  Batch<T> start_;
  T scale_;
  Batch<T> x_, gradient_, best_x_;
  Vector<double> loss_;
  Vector<T> best_;
  bool diverged_ = false;
};

class JpoFit final : public Stage {
 public:
  explicit JpoFit(const JpoOptions& options) : options_(options) {}

  std::string name() const override { return "fit"; }
  Needs needs() const override { return Needs::forward | Needs::vjp; }
  Options options() const override {
    Options all = {{"algorithm", "jpo"},
                   {"clip", fmt::format("{}", options_.clip)}};
    for (auto& option : describe(options_.step)) all.push_back(option);
    return all;
  }
  Index default_iterations() const override { return options_.iterations; }
  bool has_precision() const override { return true; }
  double operations(const CaseSize& size) const override {
    return static_cast<double>(size.n * size.iterations) *
           (3 * size.predictor_operations + 3 * size.problem_operations);
  }
  Outcome run(StageRun& run) const override {
    if (run.precision == Precision::f32)
      return JpoRun<float>(options_, run).run();
    return JpoRun<double>(options_, run).run();
  }

 private:
  JpoOptions options_;
};

}  // namespace

std::shared_ptr<const Stage> jpo_fit(const JpoOptions& options) {
  return std::make_shared<JpoFit>(options);
}

}  // namespace physinv
