#include "suite/diagnostics/work_precision.h"

#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/diagnostics/diagnostic.h"

namespace physinv {
namespace {

class WorkPrecision final : public Diagnostic {
 public:
  explicit WorkPrecision(WorkPrecisionOptions options)
      : options_(std::move(options)) {}

  std::string name() const override { return options_.name; }
  Index default_iterations() const override { return options_.repetitions; }
  bool takes_row_iterations() const override { return true; }
  bool has_precision() const override { return true; }
  double operations(const CaseSize& size) const override {
    const auto n = static_cast<double>(size.n);
    return n * (static_cast<double>(size.iterations + 1) *
                    options_.problem.make<double>()->operations() +
                options_.reference.make<double>()->operations());
  }

 protected:
  std::string kind() const override { return "work_precision"; }
  std::vector<ProblemRecipe> problems() const override {
    return {options_.problem, options_.reference};
  }
  void describe(Options& options) const override {
    options.emplace_back("problem", fingerprint({options_.problem}));
    options.emplace_back("reference", fingerprint({options_.reference}));
  }
  void diagnose(StageRun& run, Outcome& out) const override {
    run.precision == Precision::f32 ? measure<float>(run, out)
                                    : measure<double>(run, out);
  }

 private:
  template <class T>
  void measure(StageRun& run, Outcome& out) const {
    const Index n = run.oracle.count();
    const Samples<double> exact = options_.reference.make<double>()->sample(
        0, n, run.batches.child("work_precision"));
    const auto problem = options_.problem.make<T>();
    const Samples<T> s = exact.cast<T>();
    Batch<T> y(exact.y.rows(), n);
    Workspace work(run.threads);
    run.probe.begin_warmup();
    problem->forward(s.x, s.given, y, work);
    run.probe.begin();
    while (run.probe.proceed([&](BatchOut<double> x) { x = out.x; })) {
      problem->forward(s.x, s.given, y, work);
      run.oracle.add(Counter::forward, n);
    }
    Batch<double> error(1, n);
    for (Index i = 0; i < n; ++i)
      error(0, i) = number_or_none(
          relative_distance(y.col(i).template cast<double>(), exact.y.col(i)));
    out.arrays = {{"error", error}};
    out.bytes = work.bytes();
  }

  WorkPrecisionOptions options_;
};

}  // namespace

std::shared_ptr<const Stage> work_precision(WorkPrecisionOptions options) {
  return std::make_shared<WorkPrecision>(std::move(options));
}

double fastest_repetition(const Curve& curve) {
  double fastest = 0;
  for (std::size_t k = 1; k < curve.seconds.size(); ++k) {
    const double one = (curve.seconds[k] - curve.seconds[k - 1]) /
                       (curve.iteration[k] - curve.iteration[k - 1]);
    if (k == 1 || one < fastest) fastest = one;
  }
  return fastest;
}

}  // namespace physinv
