#include "suite/diagnostics/half_inverse_stress.h"

#include <algorithm>
#include <cmath>

#include "optimizers/half_inverse/half_inverse_step.h"
#include "optimizers/network_model.h"
#include "suite/core/math.h"
#include "suite/core/probe.h"
#include "suite/diagnostics/diagnostic.h"

namespace physinv {
namespace {

/// One combination.
struct Setup {
  const ProblemRecipe* problem;
  hig::Power power;
  const StressStart* start;
  Index samples, copies;
};

struct Finding {
  StressStatus status = StressStatus::ok;
  double loss_before = -1, loss_after = -1;
  double of_kept = 0, of_cut = -1, norm = 0;
  Index kept = 0, rows = 0;
  hig::Path path = hig::Path::gram;

  /// The worst of all updates counts.
  void meet(StressStatus s) { status = std::max(status, s); }
};

/// Network, physics and data of one cell.
template <class T>
class Trial {
 public:
  Trial(const StageRun& run, const Setup& setup)
      : setup_(setup),
        problem_(setup.problem->make<T>()),
        shape_(problem_->shape()),
        model_(run.setting.predictor, shape_, shape_.unknowns, nullptr) {
    const Samples<double> drawn = setup.problem->make<double>()->sample(
        0, setup.samples, run.batches.child("half_inverse_stress"));
    const Index copies = setup.copies;
    target_ = drawn.y.replicate(1, copies).template cast<T>();
    given_ = drawn.given.replicate(1, copies).template cast<T>();
    input_ = assemble<T>(run.setting.predictor.inputs,
                         drawn.x.replicate(1, copies),
                         drawn.given.replicate(1, copies),
                         drawn.y.replicate(1, copies));
    x_.resize(shape_.unknowns, count());
    y_.resize(shape_.observations, count());
    g_.resizeLike(y_);
    jacobian_.resize(x_.rows() * y_.rows(), count());
    model_.initialize(run.network_init);
    model_.parameters() *= static_cast<T>(setup.start->gain);
  }

  Finding run(Index updates, double rate) {
    Finding found{.rows = y_.size()};
    HalfInverseStep<T> step({.power = setup_.power, .rate = rate});
    found.loss_before = loss();
    for (Index k = 0; k < updates; ++k) {
      if (k > 0) loss();
      if (!update(step, k == 0, found)) break;
    }
    const double after = loss();
    found.loss_after = number_or_none(after);
    if (!std::isfinite(after) || !std::isfinite(found.loss_before))
      found.meet(StressStatus::nonfinite);
    found.loss_before = number_or_none(found.loss_before);
    return found;
  }

 private:
  Index count() const { return target_.cols(); }

  /// Mean loss at the weights as they are; leaves y.
  double loss() {
    x_ = model_.forward(input_);
    x_.colwise() += problem_->start().template cast<T>();
    problem_->forward({x_, given_}, y_, work_);
    Vector<double> losses(count());
    problem_->loss(y_, target_, losses);
    return losses.mean();
  }

  bool update(HalfInverseStep<T>& step, bool first, Finding& found) {
    problem_->loss_gradient(y_, target_, g_);
    g_ /= static_cast<T>(count());
    dynamic_cast<const Jacobian<T>&>(*problem_).jacobian(
        {x_, given_}, jacobian_, work_);
    if (setup_.start->blind) jacobian_.setZero();
    const bool taken = step(model_.network(),
                            model_.parameters(),
                            model_.tape(),
                            jacobian_,
                            g_,
                            model_.workspace());
    const hig::HalfInverseReport& report = step.report();
    if (first) found.kept = report.kept, found.path = report.path;
    if (!taken) {
      found.meet(StressStatus::nonfinite);
      return false;
    }
    if (!report.proven) found.meet(StressStatus::unproven);
    if (report.ending == hig::Ending::zero) found.meet(StressStatus::zero);
    weigh(step.update().norm(), report, found);
    return true;
  }

  void weigh(double norm,
             const hig::HalfInverseReport& report,
             Finding& found) const {
    found.norm = std::max(found.norm, norm);
    if (norm == 0) return;
    const double g = g_.template cast<double>().norm();
    const auto over = [&](double s) {
      return norm / (math::pow(s, setup_.power.kappa) * g);
    };
    found.of_kept = std::max(found.of_kept, over(report.smallest_kept));
    if (report.cut > 0) found.of_cut = std::max(found.of_cut, over(report.cut));
  }

  const Setup& setup_;
  std::unique_ptr<Problem<T>> problem_;
  Shape shape_;
  NetworkModel<T> model_;
  Batch<T> target_, given_, input_, x_, y_, g_, jacobian_;
  Workspace work_;
};

class HalfInverseStress final : public Diagnostic {
 public:
  explicit HalfInverseStress(HalfInverseStressOptions options)
      : options_(std::move(options)) {}

  std::string name() const override { return options_.name; }
  Needs needs() const override { return Needs::forward | Needs::jacobian; }
  double operations(const CaseSize& size) const override {
    return 1e4 * static_cast<double>(cells() * options_.updates) *
           size.predictor_operations;
  }

 protected:
  std::string kind() const override { return "half_inverse_stress"; }
  std::vector<ProblemRecipe> problems() const override {
    return options_.problems;
  }
  Options settings() const override { return describe(options_); }

  void diagnose(StageRun& run, Outcome& out) const override {
    run.probe.begin();
    const Index columns = cells();
    Batch<double> cell(kStressAxes, columns), status(1, columns),
        loss(2, columns), size(2, columns), norm(1, columns), kept(1, columns),
        path(1, columns), rows(1, columns);
    for (Index j = 0; j < columns; ++j) {
      const auto at = positions(j);
      for (Index a = 0; a < kStressAxes; ++a)
        cell(a, j) = static_cast<double>(at[static_cast<std::size_t>(a)]);
      const Setup setup{.problem = &options_.problems[at[0]],
                        .power = {.kappa = options_.kappas[at[2]],
                                  .tau = options_.taus[at[1]]},
                        .start = &options_.starts[at[3]],
                        .samples = options_.samples[at[4]],
                        .copies = at[5] == 0 ? 1 : 2};
      const Finding f =
          at[6] == 0
              ? Trial<float>(run, setup).run(options_.updates, options_.rate)
              : Trial<double>(run, setup).run(options_.updates, options_.rate);
      status(0, j) = static_cast<double>(f.status);
      loss.col(j) << f.loss_before, f.loss_after;
      size.col(j) << number_or_none(f.of_kept), number_or_none(f.of_cut);
      norm(0, j) = number_or_none(f.norm);
      kept(0, j) = static_cast<double>(f.kept);
      path(0, j) = static_cast<double>(f.path);
      rows(0, j) = static_cast<double>(f.rows);
    }
    out.arrays = {{"cell", cell},
                  {"status", status},
                  {"loss", loss},
                  {"size", size},
                  {"norm", norm},
                  {"kept", kept},
                  {"path", path},
                  {"rows", rows}};
  }

 private:
  std::array<std::size_t, kStressAxes> lengths() const {
    return {options_.problems.size(),
            options_.taus.size(),
            options_.kappas.size(),
            options_.starts.size(),
            options_.samples.size(),
            2,
            2};
  }
  Index cells() const {
    std::size_t count = 1;
    for (const std::size_t n : lengths()) count *= n;
    return static_cast<Index>(count);
  }
  std::array<std::size_t, kStressAxes> positions(Index cell) const {
    std::array<std::size_t, kStressAxes> at{};
    auto rest = static_cast<std::size_t>(cell);
    const auto n = lengths();
    for (std::size_t a = 0; a < n.size(); ++a) {
      at[a] = rest % n[a];
      rest /= n[a];
    }
    return at;
  }

  HalfInverseStressOptions options_;
};

}  // namespace

std::shared_ptr<const Stage> half_inverse_stress(
    HalfInverseStressOptions options) {
  return std::make_shared<HalfInverseStress>(std::move(options));
}

}  // namespace physinv
