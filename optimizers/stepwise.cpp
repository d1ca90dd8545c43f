#include "optimizers/stepwise.h"

#include <algorithm>
#include <utility>

#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace physinv {
namespace {

template <class Measured>
Outcome run_all(StepwiseSolver& solver, StageRun& run, Measured&& measured) {
  run.probe.begin_warmup();
  solver.warm_up();
  run.probe.begin();
  const Index n = run.oracle.count();
  Batch<double> x(run.oracle.shape().unknowns, n);
  const auto estimate = [&](BatchOut<double> at) {
    solver.estimate(x);
    at = x;
  };
  while (run.probe.proceed(estimate, measured)) solver.step();

  Outcome out;
  out.x = std::move(x);
  out.status.assign(static_cast<std::size_t>(n), Status::maxiter);
  out.iterations.setConstant(n, static_cast<double>(run.probe.iteration()));
  out.evaluations = out.iterations;
  solver.export_to(out);
  return out;
}

}  // namespace

Outcome run_steps(StepwiseSolver& solver, StageRun& run) {
  Outcome out = run_all(solver, run, [](BatchIn<double>, BatchIn<double>) {});
  keep_finite(out.arrays);
  return out;
}

Outcome run_steps(StepwiseSolver& solver,
                  StageRun& run,
                  const Metrics& metrics) {
  MetricsRecorder recorder(metrics, run);
  Outcome out = run_all(solver, run, [&](BatchIn<double> x, BatchIn<double> y) {
    if (!recorder.empty()) recorder(Vector<double>(), x, y);
  });
  out.arrays["mean_loss"] = run.probe.curve().loss.colwise().mean();
  if (!recorder.empty()) out.arrays["metrics"] = recorder.values();
  keep_finite(out.arrays);
  return out;
}

Examples::Examples(Index count)
    : status_(static_cast<std::size_t>(count), Status::maxiter),
      iterations_(Vector<double>::Zero(count)) {}

bool Examples::running(Index i) const {
  return status_[static_cast<std::size_t>(i)] != Status::nonfinite;
}

bool Examples::none_running() const {
  return std::all_of(status_.begin(), status_.end(), [](Status s) {
    return s == Status::nonfinite;
  });
}

void Examples::end(Index i) {
  status_[static_cast<std::size_t>(i)] = Status::nonfinite;
}

void Examples::export_to(Outcome& out) const {
  out.status = status_;
  out.iterations = iterations_;
  out.evaluations = iterations_;
}

}  // namespace physinv
