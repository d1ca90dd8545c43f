/// Least-squares training of a network on labelled samples, all of them in
/// every update: what supervised learning and surrogates share.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "optimizers/network_model.h"
#include "optimizers/steps/rule.h"
#include "optimizers/training/stage.h"

namespace physinv {

struct RegressionOptions {
  StepOptions step = AdamOptions{.rate = 1e-3};
  Index iterations = 3000;
};

/// Minimizes sum |N(input) - target|^2; `model` is bound to the input.
/// `estimate(x)` fills the true problems' estimates, also those that are left.
/// Arrays left: `weight_change`, `training_loss` (the last seen in training).
template <class T>
Outcome fit_regression(NetworkModel<T>& model,
                       Batch<T> target,
                       const RegressionOptions& options,
                       StageRun& run,
                       const std::function<void(BatchOut<double> x)>& estimate);

/// Facts of a stage `fit` that trains `network` so.
StageFacts regression_facts(std::string algorithm,
                            Needs needs,
                            Networks network,
                            const RegressionOptions& options,
                            const char* source = __builtin_FILE());

}  // namespace physinv
