#include "optimizers/half_inverse_direct.h"

#include "optimizers/half_inverse/explicit_power.h"
#include "suite/core/check.h"
#include "suite/core/option_check.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

template <class T>
class Direct {
 public:
  Direct(const HalfInverseDirectOptions& options, StageRun& run)
      : options_(options),
        run_(run),
        oracle_(run.oracle),
        problem_(oracle_.recipe().make<T>()),
        projection_(dynamic_cast<const GradientProjection<T>*>(problem_.get())),
        x_(oracle_.start().template cast<T>()),
        given_(oracle_.given().template cast<T>()),
        target_(oracle_.observations().template cast<T>()),
        y_(target_.rows(), x_.cols()),
        g_(y_),
        jacobian_(y_.rows() * x_.rows(), x_.cols()),
        update_(x_.rows()),
        metrics_(options.metrics, run),
        work_(run.threads) {
    out_.status.assign(static_cast<std::size_t>(x_.cols()), Status::maxiter);
    out_.iterations.setZero(x_.cols());
  }

  Outcome run() {
    Probe& probe = run_.probe;
    probe.begin_warmup();
    probe.begin();
    const auto measured = [&](BatchIn<double> x, BatchIn<double> y) {
      if (!metrics_.empty()) metrics_(Vector<double>(), x, y);
    };
    while (probe.proceed(
        [&](BatchOut<double> x) { x = x_.template cast<double>(); },
        measured)) {
      update();
      probe.trace(x_.data(), sizeof(T) * static_cast<std::size_t>(x_.size()));
    }
    out_.x = x_.template cast<double>();
    out_.evaluations = out_.iterations;
    out_.arrays["mean_loss"] = probe.curve().loss.colwise().mean();
    if (!metrics_.empty()) out_.arrays["metrics"] = metrics_.values();
    keep_finite(out_.arrays);
    out_.bytes = bytes();
    oracle_.add(work_.counts);
    return std::move(out_);
  }

 private:
  void update() {
    problem_->forward(x_, given_, y_, work_);
    problem_->loss_gradient(y_, target_, g_);
    if (projection_ != nullptr) projection_->project(y_, g_);
    dynamic_cast<const Jacobian<T>&>(*problem_).jacobian(
        x_, given_, jacobian_, work_);
    oracle_.add(Counter::jacobian, x_.cols());
    for (Index i = 0; i < x_.cols(); ++i) {
      Status& status = out_.status[static_cast<std::size_t>(i)];
      if (status == Status::nonfinite) continue;
      s_ = Eigen::Map<const Batch<T>>(
               jacobian_.col(i).data(), y_.rows(), x_.rows())
               .template cast<double>();
      power_.factor(s_, g_.col(i).template cast<double>());
      const hig::Ending ending = power_.apply(options_.power, update_).ending;
      next_ = x_.col(i) - (options_.rate * update_).template cast<T>();
      if ((ending != hig::Ending::ok && ending != hig::Ending::zero) ||
          !next_.allFinite()) {
        status = Status::nonfinite;
        continue;
      }
      x_.col(i) = next_;
      ++out_.iterations(i);
    }
  }

  std::size_t bytes() const {
    const Index numbers = x_.size() + given_.size() + target_.size() +
                          y_.size() + g_.size() + jacobian_.size();
    const Index doubles = 2 * s_.size() + update_.size();  // s_ and its powers
    return static_cast<std::size_t>(numbers) * sizeof(T) +
           static_cast<std::size_t>(doubles) * sizeof(double) + work_.bytes();
  }

  const HalfInverseDirectOptions& options_;
  StageRun& run_;
  Oracle& oracle_;
  std::unique_ptr<Problem<T>> problem_;
  const GradientProjection<T>* projection_;
  Batch<T> x_, given_, target_, y_, g_, jacobian_;
  Vector<T> next_;
  Batch<double> s_;
  Vector<double> update_;
  MetricsRecorder metrics_;
  hig::ExplicitPower power_;
  Workspace work_;
  Outcome out_;
};

class DirectStage final : public Stage {
 public:
  explicit DirectStage(const HalfInverseDirectOptions& options)
      : options_(options) {}

  std::string name() const override { return options_.stage; }
  Needs needs() const override { return Needs::forward | Needs::jacobian; }
  Options options() const override { return describe(options_); }
  Index default_iterations() const override { return options_.iterations; }
  bool has_precision() const override { return true; }
  Networks networks() const override { return Networks::none; }
  Sources sources() const override {
    Sources all = Stage::sources();
    options_.metrics.add_to(all);
    return all;
  }
  double operations(const CaseSize& size) const override {
    const auto rows = static_cast<double>(size.shape.observations);
    const auto columns = static_cast<double>(size.shape.unknowns);
    return static_cast<double>(size.n * size.iterations) *
           (rows * size.problem_operations + 8 * rows * rows * columns);
  }
  Outcome run(StageRun& run) const override {
    if (run.precision == Precision::f32)
      return Direct<float>(options_, run).run();
    return Direct<double>(options_, run).run();
  }

 private:
  HalfInverseDirectOptions options_;
};

}  // namespace

std::shared_ptr<const Stage> half_inverse_direct(
    const HalfInverseDirectOptions& options) {
  check_numbers<double>({{"kappa", options.power.kappa},
                         {"tau", options.power.tau},
                         {"beta", options.power.beta},
                         {"rate", options.rate}});
  SUITE_CHECK(options.iterations >= 0, "iterations are a number from 0 on");
  return std::make_shared<DirectStage>(options);
}

}  // namespace physinv
