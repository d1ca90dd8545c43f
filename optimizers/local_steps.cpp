#include "optimizers/local_steps.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "optimizers/metrics.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

const char* name_of(LocalStep step) {
  constexpr const char* kNames[] = {
      "gradient", "newton", "inverse_gradient", "inverse_simulator"};
  return kNames[static_cast<std::size_t>(step)];
}

/// What one step asks of the problem beyond its forward pass.
Needs needs_of(LocalStep step) {
  switch (step) {
    case LocalStep::gradient: return Needs::vjp;
    case LocalStep::newton: return Needs::vjp | Needs::hessian;
    case LocalStep::inverse_gradient: return Needs::jacobian;
    case LocalStep::inverse_simulator: break;
  }
  return Needs::inverse;
}

template <class T>
class LocalSteps {
 public:
  LocalSteps(const LocalStepsOptions& options, StageRun& run)
      : options_(options),
        run_(run),
        oracle_(run.oracle),
        problem_(oracle_.recipe().make<T>()),
        rate_(static_cast<T>(options.rate)),
        x_(oracle_.start().template cast<T>()),
        next_(x_),
        given_(oracle_.given().template cast<T>()),
        target_(oracle_.observations().template cast<T>()),
        y_(target_.rows(), x_.cols()),
        path_(x_.rows(), run.iterations + 1),
        work_(run.threads),
        tape_(run.threads) {
    out_.status.assign(static_cast<std::size_t>(x_.cols()), Status::maxiter);
    out_.iterations.setZero(x_.cols());
    path_.col(0) = x_.col(0).template cast<double>();
  }

  Outcome run() {
    Probe& probe = run_.probe;
    probe.begin_warmup();
    probe.begin();
    while (probe.proceed(
        [&](BatchOut<double> x) { x = x_.template cast<double>(); })) {
      propose();
      accept();
      path_.col(probe.iteration()) = x_.col(0).template cast<double>();
      probe.trace(x_.data(), sizeof(T) * static_cast<std::size_t>(x_.size()));
    }
    out_.x = x_.template cast<double>();
    out_.evaluations = out_.iterations;
    if (std::all_of(out_.status.begin(), out_.status.end(), [](Status s) {
          return s == Status::nonfinite;
        }))
      out_.stop = Stop::diverged;
    out_.arrays["mean_loss"] = probe.curve().loss.colwise().mean();
    out_.arrays["path"] = path_;
    keep_finite(out_.arrays);
    out_.bytes = bytes();
    oracle_.add(work_.counts);
    return std::move(out_);
  }

 private:
  /// Fills next_.
  void propose() {
    switch (options_.step) {
      case LocalStep::gradient:
        gradient();
        next_ = x_ - rate_ * next_;
        return;
      case LocalStep::newton:
        gradient();
        matrix_.resize(x_.rows() * x_.rows(), x_.cols());
        dynamic_cast<const Hessian<T>&>(*problem_).hessian(
            x_, given_, target_, matrix_, work_);
        solve(-rate_ * next_);
        return;
      case LocalStep::inverse_gradient:
        problem_->forward(x_, given_, y_, work_);
        oracle_.add(Counter::forward, x_.cols());
        matrix_.resize(y_.rows() * x_.rows(), x_.cols());
        dynamic_cast<const Jacobian<T>&>(*problem_).jacobian(
            x_, given_, matrix_, work_);
        oracle_.add(Counter::jacobian, x_.cols());
        solve(rate_ * (target_ - y_));
        return;
      case LocalStep::inverse_simulator:
        problem_->forward(x_, given_, y_, work_);
        y_ += rate_ * (target_ - y_);
        dynamic_cast<const Inverse<T>&>(*problem_).invert(
            y_, given_, x_, next_, work_);
        oracle_.add(Counter::forward, x_.cols());
        oracle_.add(Counter::inverse, x_.cols());
    }
  }

  /// d loss / d x, in next_.
  void gradient() {
    const auto& vjp = dynamic_cast<const Vjp<T>&>(*problem_);
    vjp.linearize(x_, given_, y_, tape_);
    y_bar_.resizeLike(y_);
    problem_->loss_gradient(y_, target_, y_bar_);
    vjp.pullback(tape_, y_bar_, next_, work_);
    oracle_.add(Counter::vjp, x_.cols());
  }

  /// next_ = x + A^-1 b, with each problem's matrix A.
  void solve(const Batch<T>& b) {
    for (Index i = 0; i < x_.cols(); ++i) {
      const Eigen::Map<const Batch<T>> a(
          matrix_.col(i).data(), b.rows(), x_.rows());
      if (a.allFinite()) {
        lu_.setThreshold(T(0));
        lu_.compute(a);
        next_.col(i) = x_.col(i) + lu_.solve(b.col(i));
      } else {
        next_.col(i).setConstant(std::numeric_limits<T>::quiet_NaN());
      }
    }
  }

  void accept() {
    for (Index i = 0; i < x_.cols(); ++i) {
      Status& status = out_.status[static_cast<std::size_t>(i)];
      if (status == Status::nonfinite) continue;
      if (next_.col(i).allFinite()) {
        x_.col(i) = next_.col(i);
        ++out_.iterations(i);
      } else {
        status = Status::nonfinite;
      }
    }
  }

  std::size_t bytes() const {
    const Index numbers = x_.size() + next_.size() + given_.size() +
                          target_.size() + y_.size() + y_bar_.size() +
                          matrix_.size();
    return static_cast<std::size_t>(numbers) * sizeof(T) +
           static_cast<std::size_t>(path_.size()) * sizeof(double) +
           work_.bytes();
  }

  const LocalStepsOptions& options_;
  StageRun& run_;
  Oracle& oracle_;
  std::unique_ptr<Problem<T>> problem_;
  T rate_;
  Batch<T> x_, next_, given_, target_, y_, y_bar_, matrix_;
  Batch<double> path_;
  Eigen::FullPivLU<Batch<T>> lu_;
  Workspace work_;
  Tape tape_;
  Outcome out_;
};

class LocalStepsStage final : public Stage {
 public:
  explicit LocalStepsStage(const LocalStepsOptions& options)
      : options_(options) {}

  std::string name() const override { return options_.stage; }
  Needs needs() const override {
    return Needs::forward | needs_of(options_.step);
  }
  Options options() const override {
    return {{"algorithm", name_of(options_.step)},
            {"rate", fmt::format("{}", options_.rate)}};
  }
  Index default_iterations() const override { return options_.iterations; }
  bool has_precision() const override { return true; }
  Networks networks() const override { return Networks::none; }
  double operations(const CaseSize& size) const override {
    const auto d = static_cast<double>(size.shape.unknowns);
    return static_cast<double>(size.n * size.iterations) *
           (3 * size.problem_operations + d * d * d);
  }
  Outcome run(StageRun& run) const override {
    if (run.precision == Precision::f32)
      return LocalSteps<float>(options_, run).run();
    return LocalSteps<double>(options_, run).run();
  }

 private:
  LocalStepsOptions options_;
};

}  // namespace

std::shared_ptr<const Stage> local_steps(const LocalStepsOptions& options) {
  return std::make_shared<LocalStepsStage>(options);
}

}  // namespace physinv
