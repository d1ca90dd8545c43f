/// Training of a network through a solver on minibatches (half-inverse
/// gradients paper, Eqs. 1 to 6):
///
///   x_i = x_start + scale N(input_i | theta),  y_i = F(x_i),
///   theta <- rule(theta, d/d theta of the batch's loss).
///
/// Batches are consecutive slices of a training set as large as the set of the
/// case, in the same order every epoch, or fresh samples for every update,
/// which are drawn while the clock stands still. The estimates of the case's
/// own problems come from the network as it stands. Ends with status diverged
/// before an update that would make a parameter infinite or NaN.
///
/// Arrays left: `parameters`, `state` (a later stage of the chain starts from
/// them), `samples_drawn` (1), `mean_loss` (1 x points of the curve, over the
/// case's problems), `batch_loss` (1 x updates, mean before the update), and
/// what `metrics` adds. A half-inverse rule leaves per update `kept` (singular
/// values), `smallest` (kept, relative to the largest) and `path`
/// (hig::Path); `unproven` (1) counts updates whose accuracy was not shown.
#pragma once

#include <memory>
#include <string>
#include <variant>

#include "optimizers/half_inverse_step.h"
#include "optimizers/metrics.h"
#include "optimizers/steps/rule.h"
#include "suite/core/method.h"

namespace physinv {

struct TrainingOptions {
  std::string stage = "train";
  std::variant<StepOptions, HalfInverseStepOptions> rule;
  Index batch = 128;
  /// Samples that first-order rules have on the tapes at once, 0: the batch.
  /// Saves memory; the gradient differs by rounding.
  Index chunk = 0;
  Index iterations = 1000;
  bool own_length = false;  ///< `iterations` stands, whatever a row says
  /// g = gradient_scale / batch * dLoss_i/dy_i: 1 is the batch's mean.
  double gradient_scale = 1;
  bool fresh = false;  ///< every update draws samples never seen before
  /// Half-inverse rules project g first, if the problem can: the same update
  /// but for rounding.
  bool project = true;
  Metrics metrics = {};
};

std::shared_ptr<const Stage> train(const TrainingOptions& options);

}  // namespace physinv
