/// Training of a network on minibatches of problems (half-inverse gradients
/// paper, Eqs. 1 to 6),
///
///   x_i = N(input_i | theta) by its output map,   theta <- rule(signal),
///
/// the signal being, unless another is named, the gradient of the batch's loss
/// through the solver. The estimates of the case's own problems come from the
/// present network. Ends with status diverged before an update that would make
/// a parameter infinite or NaN.
///
/// Arrays left: `parameters`, `state` (a later stage of the chain starts from
/// them), `samples_drawn` (1), `mean_loss` (1 x points of the curve, over the
/// case's problems), what `metrics` adds, `late_error` (1), what signal
/// (training/batch_signal.h) and rule leave.
#pragma once

#include <memory>
#include <string>
#include <variant>

#include "optimizers/half_inverse/options.h"
#include "optimizers/metrics.h"
#include "optimizers/steps/adahessian.h"
#include "optimizers/steps/rule.h"
#include "optimizers/training/hessian_free.h"
#include "optimizers/training/signal_recipe.h"
#include "optimizers/training/solver_loss.h"

namespace physinv {

struct TrainingOptions {
  std::string stage = "train";
  std::variant<StepOptions,
               HalfInverseStepOptions,
               AdaHessianOptions,
               HessianFreeOptions>
      rule;
  Index batch = 128;
  Index chunk = 0;  ///< see SignalOptions
  Index iterations = 1000;
  bool own_length = false;    ///< `iterations` is used, whatever a row says
  double gradient_scale = 1;  ///< see SignalOptions
  bool fresh = false;         ///< every update draws samples never seen before
  Index set = 0;              ///< see BatchOptions
  bool project = true;        ///< see SignalOptions
  Metrics metrics = {};
  LateError late = {};
  SignalRecipe signal = solver_loss();

  auto fields() const {
    return std::tuple{field("algorithm", signal),
                      field("batch", batch),
                      field("gradient_scale", gradient_scale),
                      field("fresh", fresh),
                      field("metrics", metrics),
                      if_changed(field("chunk", chunk)),
                      if_changed(field("set", set)),
                      if_changed(field("project", project)),
                      if_changed(field("late", late)),
                      field("rule", rule),
                      implied(stage, iterations, own_length)};
  }
};

std::shared_ptr<const Stage> train(const TrainingOptions& options);

}  // namespace physinv
