#include "optimizers/minimize.h"

#include <algorithm>
#include <utility>

#include "optimizers/drive.h"
#include "suite/core/probe.h"

namespace physinv {

namespace {

/// Losses and gradients at x, rounded to float.
class InFloat {
 public:
  void evaluate(Oracle& oracle,
                std::span<const Index> active,
                BatchIn<double> x,
                VectorOut<double> loss,
                BatchOut<double> gradient) {
    x_ = x.cast<float>();
    gradient_.resize(x.rows(), x.cols());
    oracle.evaluate<float>(active, x_, loss, gradient_);
    loss = loss.cast<float>().cast<double>().eval();
    gradient = gradient_.cast<double>();
  }

 private:
  Batch<float> x_, gradient_;
};

}  // namespace

Outcome minimize(BatchedSolver& solver,
                 StageRun& run,
                 const Batch<double>& x0,
                 Precision precision) {
  Oracle& oracle = run.oracle;
  const bool single = precision == Precision::f32;
  InFloat rounded;
  Batch<double> first_step = Batch<double>::Zero(1, x0.cols());
  run.probe.begin_warmup();
  single ? oracle.warm_up<float>() : oracle.warm_up<double>();
  run.probe.begin();
  drive(
      solver,
      [&](std::span<const Index> active,
          BatchIn<double> x,
          VectorOut<double> loss,
          BatchOut<double> gradient) {
        if (single)
          rounded.evaluate(oracle, active, x, loss, gradient);
        else
          oracle.evaluate<double>(active, x, loss, gradient);
        run.probe.trace(x.data(),
                        sizeof(double) * static_cast<std::size_t>(x.size()));
      },
      x0,
      [&](const BatchedSolver& s) {
        for (const Index i : s.accepted()) {
          const Index k = s.iterations()[static_cast<std::size_t>(i)];
          run.probe.accept(i, k, s.x().col(i).data(), s.loss()(i));
          if (k == 1) first_step(0, i) = (s.x().col(i) - x0.col(i)).norm();
        }
      });
  run.probe.finish();
  Outcome out = outcome_of(solver, oracle);
  out.arrays["first_step"] = std::move(first_step);
  if (single) out.arrays["own_loss"] = solver.loss().transpose();
  return out;
}

Outcome outcome_of(const BatchedSolver& solver, Oracle& oracle) {
  const auto n = static_cast<Index>(solver.status().size());
  Outcome out;
  out.x = solver.x();
  out.status = solver.status();
  out.iterations =
      Eigen::Map<const Vector<Index>>(solver.iterations().data(), n)
          .cast<double>();
  out.evaluations =
      Eigen::Map<const Vector<Index>>(solver.evaluations().data(), n)
          .cast<double>();
  out.stop = std::ranges::all_of(out.status, converged) ? Stop::converged
                                                        : Stop::iterations;
  oracle.add(Counter::skipped_forward,
             static_cast<Index>(solver.skipped_evaluations()));
  oracle.add(Counter::skipped_trials,
             static_cast<Index>(solver.skipped_trials()));
  return out;
}

}  // namespace physinv
