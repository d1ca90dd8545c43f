/// Least-squares training of a network on labelled samples: what supervised
/// learning and surrogates share.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "optimizers/network_model.h"
#include "optimizers/stage.h"
#include "optimizers/steps/rule.h"

namespace physinv {

struct RegressionOptions {
  StepOptions step = AdamOptions{.rate = 1e-3};
  Index iterations = 3000;

  auto fields() const {
    return std::tuple{field("step", step), implied(iterations)};
  }
};

/// Inputs and targets, a sample per column. The network's first `bounded`
/// outputs count as tanh of what they say.
template <class T>
struct TrainingSet {
  Batch<T> input, target;
  Index bounded = 0;
};

/// Minimizes sum |N(input) - target|^2 over all samples, or over batches of as
/// many as there are problems. `estimate(x)` fills the true problems'
/// estimates, also those that are left. Arrays left: `weight_change`,
/// `training_loss` (the last seen in training).
template <class T>
Outcome fit_regression(NetworkModel<T>& model,
                       TrainingSet<T> set,
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
