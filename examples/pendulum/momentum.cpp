#include "momentum.h"

#include "optimizers/stage.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace pendulum {
namespace {

/// The oracle hides the solutions and counts; the probe keeps the clock and
/// measures the curve while it is stopped.
Outcome solve(const MomentumOptions& options, StageRun& run) {
  Batch<double> x = run.oracle.start(),
                v = Batch<double>::Zero(x.rows(), x.cols()),
                gradient(x.rows(), x.cols());
  Vector<double> loss(x.cols());
  while (run.probe.proceed([&](BatchOut<double> out) { out = x; })) {
    run.oracle.evaluate<double>(run.oracle.all(), x, loss, gradient);
    v = options.momentum * v - options.rate * gradient;
    x += v;
    run.probe.trace(x.data(),
                    static_cast<std::size_t>(x.size()) * sizeof(double));
  }
  Outcome out;
  out.x = std::move(x);
  return out;
}

}  // namespace

std::shared_ptr<const Stage> momentum_solve(const MomentumOptions& options) {
  const auto operations = [](const CaseSize& size) {
    return 3 * size.problem_operations *
           static_cast<double>(size.n * size.iterations);
  };
  return make_stage({.name = "solve",
                     .needs = Needs::forward | Needs::vjp,
                     .options = describe(options),
                     .iterations = options.iterations,
                     .networks = Networks::none,
                     .operations = operations},
                    [options](StageRun& run) { return solve(options, run); });
}

}  // namespace pendulum
