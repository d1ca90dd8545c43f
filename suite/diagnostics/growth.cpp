#include "suite/diagnostics/growth.h"

#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/diagnostics/diagnostic.h"

namespace physinv {
namespace {

/// What one precision finds for every sample of one horizon.
struct Growth {
  Batch<double> y, gradient;
  Vector<double> perturbation;
};

template <class T>
Growth measure(const ProblemRecipe& recipe,
               const Samples<double>& exact,
               const Batch<double>& others,
               double size,
               Threads* threads) {
  const auto problem = recipe.make<T>();
  const auto* vjp = dynamic_cast<const Vjp<T>*>(problem.get());
  Workspace work(threads);
  Tape tape;
  const Index n = exact.count();
  const Samples<T> s = exact.cast<T>();
  const Batch<T> start = problem->start().template cast<T>().replicate(1, n);
  Batch<T> y(exact.y.rows(), n), y_bar = y, gradient = start, moved = y;
  vjp->linearize({start, s.given}, y, tape);
  problem->loss_gradient(y, s.y, y_bar);
  vjp->pullback(tape, y_bar, gradient, work);

  Batch<T> given = s.given;
  for (Index i = 0; i < n; ++i)
    given.col(i) +=
        (size * exact.given.col(i).norm() * others.col(i).normalized())
            .template cast<T>();
  problem->forward({s.x, s.given}, y, work);
  problem->forward({s.x, given}, moved, work);
  // The differences that were taken, after rounding.
  return {y.template cast<double>(),
          gradient.template cast<double>(),
          (moved - y).template cast<double>().colwise().norm().cwiseQuotient(
              (given - s.given).template cast<double>().colwise().norm())};
}

class GrowthStage final : public Diagnostic {
 public:
  explicit GrowthStage(GrowthOptions options) : options_(std::move(options)) {}

  std::string name() const override { return options_.name; }
  Needs needs() const override { return Needs::forward | Needs::vjp; }
  double operations(const CaseSize& size) const override {
    double sum = 0;
    for (const auto& h : options_.horizons)
      sum += h.problem.make<double>()->operations();
    return 12 * static_cast<double>(size.n) * sum;
  }

 protected:
  std::string kind() const override { return "growth"; }
  std::vector<ProblemRecipe> problems() const override {
    return options_.problems();
  }
  Options settings() const override { return describe(options_); }
  void diagnose(StageRun& run, Outcome& out) const override {
    run.probe.begin();
    const Index n = run.oracle.count();
    const auto horizons = static_cast<Index>(options_.horizons.size());
    const auto array = [&](ArrayKey name) -> Batch<double>& {
      return out.arrays[name] = Batch<double>(n, horizons);
    };
    auto &gradient = array("gradient"), &single = array("gradient_single"),
         &error = array("gradient_error"), &moved = array("perturbation"),
         &moved_single = array("perturbation_single"),
         &rounding = array("rounding");
    auto& time = out.arrays["time"] = Batch<double>(1, horizons);
    const Rng rng = run.batches.child("growth");
    for (Index k = 0; k < horizons; ++k) {
      const auto& [end, recipe] =
          options_.horizons[static_cast<std::size_t>(k)];
      const auto problem = recipe.make<double>();
      const auto samples = problem->sample(0, n, rng);
      const auto others = problem->sample(n, n, rng).given;
      const Growth exact =
          measure<double>(recipe, samples, others, 1e-8, run.threads);
      const Growth rough =
          measure<float>(recipe, samples, others, 1e-3, run.threads);
      run.oracle.add(Counter::forward, 4 * n);
      run.oracle.add(Counter::vjp, 2 * n);
      time(0, k) = end;
      for (Index i = 0; i < n; ++i) {
        gradient(i, k) = number_or_none(exact.gradient.col(i).norm());
        single(i, k) = number_or_none(rough.gradient.col(i).norm());
        error(i, k) = number_or_none(
            relative_distance(rough.gradient.col(i), exact.gradient.col(i)));
        moved(i, k) = number_or_none(exact.perturbation(i));
        moved_single(i, k) = number_or_none(rough.perturbation(i));
        rounding(i, k) =
            number_or_none(relative_distance(rough.y.col(i), exact.y.col(i)));
      }
    }
  }

 private:
  GrowthOptions options_;
};

}  // namespace

std::vector<ProblemRecipe> GrowthOptions::problems() const {
  std::vector<ProblemRecipe> all;
  for (const auto& h : horizons) all.push_back(h.problem);
  return all;
}

std::shared_ptr<const Stage> growth(GrowthOptions options) {
  return std::make_shared<GrowthStage>(std::move(options));
}

}  // namespace physinv
