/// Least-squares training of a network on labelled samples, full batch: the
/// loop that supervised learning and surrogates share.
#pragma once

#include <memory>
#include <string>

#include "optimizers/network_model.h"
#include "optimizers/steps/rule.h"

namespace physinv {

struct RegressionOptions {
  StepOptions step = AdamOptions{.rate = 1e-3};
  Index iterations = 3000;
};

/// What distinguishes one stage of this kind from another.
struct RegressionFit {
  std::string algorithm;  ///< for the record
  Needs needs;
  double CaseSize::*operations;  ///< of the network's forward pass
  Outcome (*in_float)(const RegressionOptions& options, StageRun& run);
  Outcome (*in_double)(const RegressionOptions& options, StageRun& run);
};

/// Stage `fit`.
std::shared_ptr<const Stage> regression_stage(const RegressionFit& fit,
                                              const RegressionOptions& options);

/// Minimizes sum |N(input) - target|^2; `model` is bound to the input.
/// `estimate(x)` fills the true problems' estimates when a point of the curve
/// is due. Returns the last loss seen in training.
template <class T, class Estimate>
double fit_regression(NetworkModel<T>& model,
                      const Batch<T>& target,
                      const RegressionOptions& options,
                      StageRun& run,
                      Estimate&& estimate) {
  UpdateStep<T> update(options.step);
  Batch<T> residual(target.rows(), target.cols());
  double loss = 0;
  run.probe.begin_warmup();
  model.warm_up();
  run.probe.begin();
  while (run.probe.proceed(estimate)) {
    residual.noalias() = model.forward() - target;
    model.update_state();
    loss = residual.template cast<double>().squaredNorm();
    residual *= T(2);
    update(model.parameters(), model.backward(residual));
    if (run.probe.traced()) {
      run.probe.trace(&loss, sizeof(loss));
      run.probe.trace(
          model.parameters().data(),
          sizeof(T) * static_cast<std::size_t>(model.parameters().size()));
    }
  }
  return loss;
}

/// What is left by a trained network: iterations, loss, change per tensor.
template <class T>
Outcome regression_outcome(const NetworkModel<T>& model,
                           double loss,
                           StageRun& run) {
  Outcome out;
  out.iterations.setConstant(run.oracle.count(),
                             static_cast<double>(run.probe.iteration()));
  out.arrays["weight_change"] = model.change_per_tensor(run.network_init);
  out.arrays["training_loss"] = Batch<double>::Constant(1, 1, loss);
  out.bytes = model.bytes();
  run.oracle.add(model.counts());
  return out;
}

}  // namespace physinv
