#include "optimizers/local_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimizers/steps/rule_check.h"
#include "optimizers/training/newton.h"
#include "suite/core/check.h"
#include "suite/core/closed_steps.h"
#include "suite/core/decompositions.h"
#include "suite/core/option_check.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

Needs needs_of(const LocalStepsOptions& options) {
  switch (options.step) {
    case LocalStep::gradient:
      return Needs::forward | Needs::vjp;
    case LocalStep::newton:
      return Needs::forward | Needs::vjp | Needs::hessian;
    case LocalStep::inverse_gradient:
      return Needs::forward | Needs::jacobian;
    case LocalStep::inverse_simulator:
      return Needs::forward | Needs::inverse;
    case LocalStep::inverse_search:
      break;
  }
  return options.search.difference > 0 ? Needs::forward
                                       : Needs::forward | Needs::vjp;
}

template <class T>
class LocalSteps {
 public:
  LocalSteps(const LocalStepsOptions& options, StageRun& run)
      : options_(options),
        run_(run),
        oracle_(run.oracle),
        problem_(oracle_.recipe().make<T>()),
        closed_(dynamic_cast<const ClosedSteps<T>*>(problem_.get())),
        rate_(static_cast<T>(options.rate)),
        x_(oracle_.start().template cast<T>()),
        next_(x_),
        given_(oracle_.given().template cast<T>()),
        target_(oracle_.observations().template cast<T>()),
        y_(target_.rows(), x_.cols()),
        y_bar_(y_),
        path_(x_.rows() * std::min(options.paths, x_.cols()),
              run.iterations + 1),
        work_(run.threads),
        tape_(run.threads) {
    check_numbers<T>({{"rate", options.rate}});
    out_.status.assign(static_cast<std::size_t>(x_.cols()), Status::maxiter);
    out_.iterations.setZero(x_.cols());
    if constexpr (std::is_same_v<T, double>)
      search_ = std::make_unique<NumericInverse>(
          *problem_, options.search, run.threads);
    if (options.rule) {
      check_rule<T>(*options.rule);
      rule_.emplace(*options.rule);
    }
  }

  Outcome run() {
    Probe& probe = run_.probe;
    probe.begin_warmup();
    probe.begin();
    keep_path();
    while (probe.proceed(
        [&](BatchOut<double> x) { x = x_.template cast<double>(); })) {
      propose();
      accept();
      keep_path();
      probe.trace(x_.data(), sizeof(T) * static_cast<std::size_t>(x_.size()));
    }
    out_.x = x_.template cast<double>();
    out_.evaluations = out_.iterations;
    const auto ended = [](Status s) { return s == Status::nonfinite; };
    if (std::all_of(out_.status.begin(), out_.status.end(), ended))
      out_.stop = Stop::diverged;
    if (path_.rows() > 0) out_.arrays["path"] = path_;
    out_.bytes = bytes();
    if (search_) oracle_.add(search_->counts());
    oracle_.add(work_.counts);
    return std::move(out_);
  }

 private:
  /// Fills next_.
  void propose() {
    switch (options_.step) {
      case LocalStep::gradient:
        gradient();
        if (rule_) {
          const auto numbers = [](Batch<T>& b) {
            return Eigen::Map<Vector<T>>(b.data(), b.size());
          };
          (*rule_)(numbers(x_), numbers(next_), numbers(next_));
        } else {
          go(-rate_);
        }
        return;
      case LocalStep::newton:
        newton();
        go(rate_);
        return;
      case LocalStep::inverse_gradient:
        inverse_gradient();
        go(rate_);
        return;
      case LocalStep::inverse_simulator:
        closer_observation();
        dynamic_cast<const Inverse<T>&>(*problem_).invert(
            y_, given_, x_, next_, work_);
        oracle_.add(Counter::inverse, x_.cols());
        return;
      case LocalStep::inverse_search:
        closer_observation();
        if constexpr (std::is_same_v<T, double>)
          search_->invert(y_, given_, x_, next_);
    }
  }

  /// next_ = x + factor next_.
  void go(T factor) {
    BatchOut<T> out = next_;
    for_numbers<T>(next_, x_, out, [factor](T step, T x) {
      return std::fma(factor, step, x);
    });
  }

  /// d loss / d x, in next_.
  void gradient() {
    const auto& vjp = dynamic_cast<const Vjp<T>&>(*problem_);
    vjp.linearize(x_, given_, y_, tape_);
    problem_->loss_gradient(y_, target_, y_bar_);
    vjp.pullback(tape_, y_bar_, next_, work_);
    oracle_.add(Counter::vjp, x_.cols());
  }

  /// -H^-1 d loss / d x, in next_.
  void newton() {
    if (closed_ != nullptr) {
      closed_->newton_step(x_, given_, target_, next_);
      oracle_.add(Counter::vjp, x_.cols());
      return;
    }
    gradient();
    const Index d = x_.rows();
    matrix_.resize(d * d, x_.cols());
    dynamic_cast<const Hessian<T>&>(*problem_).hessian(
        x_, given_, target_, matrix_, work_);
    for (Index i = 0; i < x_.cols(); ++i) {
      const Eigen::Map<const Batch<T>> h(matrix_.col(i).data(), d, d);
      next_.col(i) = newton_step({.flip = false},
                                 next_.col(i).template cast<double>(),
                                 h.template cast<double>())
                         .template cast<T>();
    }
  }

  /// J^-1 (y* - y), in next_.
  void inverse_gradient() {
    oracle_.add(Counter::jacobian, x_.cols());
    if (closed_ != nullptr) {
      closed_->inverse_gradient_step(x_, given_, target_, next_);
      return;
    }
    forward();
    matrix_.resize(y_.rows() * x_.rows(), x_.cols());
    dynamic_cast<const Jacobian<T>&>(*problem_).jacobian(
        x_, given_, matrix_, work_);
    for (Index i = 0; i < x_.cols(); ++i) {
      const Eigen::Map<const Batch<T>> j(
          matrix_.col(i).data(), y_.rows(), x_.rows());
      if (!j.allFinite()) {
        next_.col(i).setConstant(std::numeric_limits<T>::quiet_NaN());
        continue;
      }
      lu_.solve(j, target_.col(i) - y_.col(i), next_.col(i));
    }
  }

  void forward() {
    problem_->forward(x_, given_, y_, work_);
    oracle_.add(Counter::forward, x_.cols());
  }

  /// y + dy, in y_.
  void closer_observation() {
    forward();
    BatchOut<T> out = y_;
    for_numbers<T>(y_, target_, out, [rate = rate_](T y, T goal) {
      return std::fma(rate, goal - y, y);
    });
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

  void keep_path() {
    path_.col(run_.probe.iteration()) =
        x_.reshaped().head(path_.rows()).template cast<double>();
  }

  std::size_t bytes() const {
    const Index numbers =
        x_.size() + next_.size() + given_.size() + target_.size() + y_.size() +
        y_bar_.size() + matrix_.size() +
        (rule_ ? rule_->numbers_per_parameter() : 0) * x_.size();
    return static_cast<std::size_t>(numbers) * sizeof(T) +
           static_cast<std::size_t>(path_.size()) * sizeof(double) +
           (search_ ? search_->bytes() : 0) + work_.bytes() + tape_.bytes();
  }

  const LocalStepsOptions& options_;
  StageRun& run_;
  Oracle& oracle_;
  std::unique_ptr<Problem<T>> problem_;
  const ClosedSteps<T>* closed_;
  std::unique_ptr<NumericInverse> search_;
  std::optional<UpdateStep<T>> rule_;
  T rate_;
  Batch<T> x_, next_, given_, target_, y_, y_bar_, matrix_;
  Batch<double> path_;
  FullyPivoted<T> lu_;
  Workspace work_;
  Tape tape_;
  Outcome out_;
};

class LocalStepsStage final : public Stage {
 public:
  explicit LocalStepsStage(const LocalStepsOptions& options)
      : options_(options) {
    check_numbers<double>({{"rate", options.rate}});
    SUITE_CHECK(options.iterations >= 0 && options.paths >= 0,
                "iterations and paths are numbers from 0 on");
  }

  std::string name() const override { return "solve"; }
  Needs needs() const override { return needs_of(options_); }
  Options options() const override { return describe(options_); }
  Index default_iterations() const override { return options_.iterations; }
  Sources sources() const override {
    Sources all = Stage::sources();
    add_sources(options_.rule.value_or(SgdOptions{}), all);
    return all;
  }
  bool has_precision() const override { return !searches(); }
  Networks networks() const override { return Networks::none; }
  double operations(const CaseSize& size) const override {
    const auto d = static_cast<double>(size.shape.unknowns);
    const bool solves = options_.step == LocalStep::newton ||
                        options_.step == LocalStep::inverse_gradient;
    return static_cast<double>(size.n * size.iterations) *
           ((searches() ? 100 : 3) * size.problem_operations +
            (solves ? d * d * d : 0));
  }
  Outcome run(StageRun& run) const override {
    if (run.precision == Precision::f32 && !searches())
      return LocalSteps<float>(options_, run).run();
    return LocalSteps<double>(options_, run).run();
  }

 private:
  bool searches() const { return options_.step == LocalStep::inverse_search; }

  LocalStepsOptions options_;
};

}  // namespace

std::string_view to_string(LocalStep step) {
  constexpr std::string_view kNames[] = {"gradient",
                                         "newton",
                                         "inverse_gradient",
                                         "inverse_simulator",
                                         "inverse_search"};
  return kNames[static_cast<std::size_t>(step)];
}

std::shared_ptr<const Stage> local_steps(const LocalStepsOptions& options) {
  SUITE_CHECK(!options.rule || options.rate == LocalStepsOptions{}.rate,
              "a rule of steps has its rate among its own options");
  return std::make_shared<LocalStepsStage>(options);
}

}  // namespace physinv
