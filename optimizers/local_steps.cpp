#include "optimizers/local_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimizers/stage.h"
#include "optimizers/steps/rule_check.h"
#include "optimizers/stepwise.h"
#include "optimizers/training/newton.h"
#include "suite/core/check.h"
#include "suite/core/option_check.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/linalg/decompositions.h"

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
class LocalSteps final : public StepwiseSolver {
 public:
  LocalSteps(const LocalStepsOptions& options, StageRun& run)
      : options_(options),
        probe_(run.probe),
        oracle_(run.oracle),
        problem_(oracle_.problem<T>()),
        rate_(static_cast<T>(options.rate)),
        x_(oracle_.start().template cast<T>()),
        next_(x_),
        given_(oracle_.given().template cast<T>()),
        target_(oracle_.observations().template cast<T>()),
        y_(target_.rows(), x_.cols()),
        y_bar_(y_),
        path_(x_.rows() * std::min(options.paths, x_.cols()),
              run.iterations + 1),
        examples_(x_.cols()) {
    check_numbers<T>({{"rate", options.rate}});
    if constexpr (std::is_same_v<T, double>)
      search_ = std::make_unique<NumericInverse>(oracle_.problem<double>(),
                                                 options.search);
    if (options.rule) {
      check_rule<T>(*options.rule);
      rule_.emplace(*options.rule);
    }
  }

  void warm_up() override { keep_path(); }
  void step() override {
    propose();
    accept();
    keep_path();
    probe_.trace(x_.data(), sizeof(T) * static_cast<std::size_t>(x_.size()));
  }
  void estimate(BatchOut<double> x) override { x = x_.template cast<double>(); }
  void export_to(Outcome& out) override {
    examples_.export_to(out);
    if (examples_.none_running()) out.stop = Stop::diverged;
    if (path_.rows() > 0) out.arrays["path"] = path_;
    out.bytes = bytes();
    if (search_) oracle_.add(search_->counts());
    oracle_.add(problem_.counts());
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
          step_by(-rate_);
        }
        return;
      case LocalStep::newton:
        newton();
        step_by(rate_);
        return;
      case LocalStep::inverse_gradient:
        inverse_gradient();
        step_by(rate_);
        return;
      case LocalStep::inverse_simulator:
        closer_observation();
        problem_.invert(y_, given_, x_, next_);
        return;
      case LocalStep::inverse_search:
        closer_observation();
        if constexpr (std::is_same_v<T, double>)
          search_->invert(y_, given_, x_, next_);
    }
  }

  /// next_ = x + factor next_.
  void step_by(T factor) {
    BatchOut<T> out = next_;
    for_numbers<T>(next_, x_, out, [factor](T step, T x) {
      return std::fma(factor, step, x);
    });
  }

  /// d loss / d x, in next_.
  void gradient() {
    problem_.linearize(x_, given_, y_);
    problem_.loss_gradient(y_, target_, y_bar_);
    problem_.pullback(y_bar_, next_);
  }

  /// -H^-1 d loss / d x, in next_.
  void newton() {
    if (problem_.has_closed_steps())
      return problem_.newton_step(x_, given_, target_, next_);
    gradient();
    const Index d = x_.rows();
    matrix_.resize(d * d, x_.cols());
    problem_.hessian(x_, given_, target_, matrix_);
    for (Index i = 0; i < x_.cols(); ++i) {
      const Eigen::Map<const Batch<T>> h(matrix_.col(i).data(), d, d);
      next_.col(i) = newton_step({.flip = false},
                                 next_.col(i).template cast<double>(),
                                 h.template cast<double>(),
                                 std::numeric_limits<T>::epsilon())
                         .template cast<T>();
    }
  }

  /// J^-1 (y* - y), in next_.
  void inverse_gradient() {
    if (problem_.has_closed_steps())
      return problem_.inverse_gradient_step(x_, given_, target_, next_);
    matrix_.resize(y_.rows() * x_.rows(), x_.cols());
    problem_.jacobian(x_, given_, y_, matrix_);
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

  /// y + dy, in y_.
  void closer_observation() {
    problem_.forward(x_, given_, y_);
    BatchOut<T> out = y_;
    for_numbers<T>(y_, target_, out, [rate = rate_](T y, T goal) {
      return std::fma(rate, goal - y, y);
    });
  }

  void accept() {
    for (Index i = 0; i < x_.cols(); ++i) {
      if (!examples_.running(i)) continue;
      if (next_.col(i).allFinite()) {
        x_.col(i) = next_.col(i);
        examples_.count(i);
      } else {
        examples_.end(i);
      }
    }
  }

  void keep_path() {
    path_.col(probe_.iteration()) =
        x_.reshaped().head(path_.rows()).template cast<double>();
  }

  std::size_t bytes() const {
    const Index numbers =
        x_.size() + next_.size() + given_.size() + target_.size() + y_.size() +
        y_bar_.size() + matrix_.size() +
        (rule_ ? rule_->numbers_per_parameter() : 0) * x_.size();
    return static_cast<std::size_t>(numbers) * sizeof(T) +
           static_cast<std::size_t>(path_.size()) * sizeof(double) +
           (search_ ? search_->bytes() : 0) + problem_.bytes();
  }

  const LocalStepsOptions& options_;
  Probe& probe_;
  Oracle& oracle_;
  CountedProblem<T> problem_;
  std::unique_ptr<NumericInverse> search_;
  std::optional<UpdateStep<T>> rule_;
  T rate_;
  Batch<T> x_, next_, given_, target_, y_, y_bar_, matrix_;
  Batch<double> path_;
  linalg::FullyPivoted<T> lu_;
  Examples examples_;
};

bool searches(const LocalStepsOptions& options) {
  return options.step == LocalStep::inverse_search;
}

double operations(const LocalStepsOptions& options, const CaseSize& size) {
  const auto d = static_cast<double>(size.shape.unknowns);
  const bool solves = options.step == LocalStep::newton ||
                      options.step == LocalStep::inverse_gradient;
  return static_cast<double>(size.n * size.iterations) *
         ((searches(options) ? 100 : 3) * size.problem_operations +
          (solves ? d * d * d : 0));
}

template <class T>
Outcome run_in(const LocalStepsOptions& options, StageRun& run) {
  LocalSteps<T> solver(options, run);
  return run_steps(solver, run);
}

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
              "set the rate of a step rule in the options of the rule");
  check_numbers<double>({{"rate", options.rate}});
  SUITE_CHECK(options.iterations >= 0 && options.paths >= 0,
              "iterations and paths must not be negative");
  Sources sources;
  add_sources(options.rule.value_or(SgdOptions{}), sources);
  StageFacts facts{
      .name = "solve",
      .needs = needs_of(options),
      .options = describe(options),
      .iterations = options.iterations,
      .networks = Networks::none,
      .operations =
          [options](const CaseSize& size) { return operations(options, size); },
      .sources = std::move(sources)};
  if (searches(options))
    return make_stage(std::move(facts), [options](StageRun& run) {
      return run_in<double>(options, run);
    });
  return make_stage(std::move(facts), [options]<class T>(StageRun& run) {
    return run_in<T>(options, run);
  });
}

}  // namespace physinv
