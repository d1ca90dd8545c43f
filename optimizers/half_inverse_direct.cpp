#include "optimizers/half_inverse_direct.h"

#include "optimizers/half_inverse/explicit_power.h"
#include "optimizers/stage.h"
#include "optimizers/stepwise.h"
#include "suite/core/check.h"
#include "suite/core/option_check.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

template <class T>
class Direct final : public StepwiseSolver {
 public:
  Direct(const HalfInverseDirectOptions& options, StageRun& run)
      : options_(options),
        probe_(run.probe),
        oracle_(run.oracle),
        problem_(oracle_.problem<T>()),
        x_(oracle_.start().template cast<T>()),
        given_(oracle_.given().template cast<T>()),
        target_(oracle_.observations().template cast<T>()),
        y_(target_.rows(), x_.cols()),
        g_(y_),
        jacobian_(y_.rows() * x_.rows(), x_.cols()),
        update_(x_.rows()),
        examples_(x_.cols()) {}

  void step() override {
    update();
    probe_.trace(x_.data(), sizeof(T) * static_cast<std::size_t>(x_.size()));
  }
  void estimate(BatchOut<double> x) override { x = x_.template cast<double>(); }
  void export_to(Outcome& out) override {
    examples_.export_to(out);
    out.bytes = bytes();
    oracle_.add(problem_.counts());
  }

 private:
  void update() {
    problem_.jacobian(x_, given_, y_, jacobian_);
    problem_.loss_gradient(y_, target_, g_);
    problem_.project(y_, g_);
    for (Index i = 0; i < x_.cols(); ++i) {
      if (!examples_.running(i)) continue;
      s_ = Eigen::Map<const Batch<T>>(
               jacobian_.col(i).data(), y_.rows(), x_.rows())
               .template cast<double>();
      power_.factor(s_, g_.col(i).template cast<double>());
      const hig::Ending ending = power_.apply(options_.power, update_).ending;
      next_ = x_.col(i) - (options_.rate * update_).template cast<T>();
      if ((ending != hig::Ending::ok && ending != hig::Ending::zero) ||
          !next_.allFinite()) {
        examples_.end(i);
        continue;
      }
      x_.col(i) = next_;
      examples_.count(i);
    }
  }

  std::size_t bytes() const {
    const Index numbers = x_.size() + given_.size() + target_.size() +
                          y_.size() + g_.size() + jacobian_.size();
    const Index doubles = 2 * s_.size() + update_.size();  // s_ and its powers
    return static_cast<std::size_t>(numbers) * sizeof(T) +
           static_cast<std::size_t>(doubles) * sizeof(double) +
           problem_.bytes();
  }

  const HalfInverseDirectOptions& options_;
  Probe& probe_;
  Oracle& oracle_;
  CountedProblem<T> problem_;
  Batch<T> x_, given_, target_, y_, g_, jacobian_;
  Vector<T> next_;
  Batch<double> s_;
  Vector<double> update_;
  hig::ExplicitPower power_;
  Examples examples_;
};

}  // namespace

std::shared_ptr<const Stage> half_inverse_direct(
    const HalfInverseDirectOptions& options) {
  check_numbers<double>({{"kappa", options.power.kappa},
                         {"tau", options.power.tau},
                         {"beta", options.power.beta},
                         {"rate", options.rate}});
  SUITE_CHECK(options.iterations >= 0, "iterations must not be negative");
  Sources sources;
  options.metrics.add_to(sources);
  const auto operations = [](const CaseSize& size) {
    const auto rows = static_cast<double>(size.shape.observations);
    const auto columns = static_cast<double>(size.shape.unknowns);
    return static_cast<double>(size.n * size.iterations) *
           (rows * size.problem_operations + 8 * rows * rows * columns);
  };
  return make_stage({.name = options.stage,
                     .needs = Needs::forward | Needs::jacobian,
                     .options = describe(options),
                     .iterations = options.iterations,
                     .networks = Networks::none,
                     .operations = operations,
                     .sources = sources},
                    [options]<class T>(StageRun& run) {
                      Direct<T> solver(options, run);
                      return run_steps(solver, run, options.metrics);
                    });
}

}  // namespace physinv
