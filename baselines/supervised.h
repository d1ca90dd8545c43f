/// Supervised learning (JPO paper, Eq. 10): the network of JPO, trained on
/// labelled samples (x_j, y_j) of a separate set,
///
///   min_theta  sum_j |N(given_j, y_j | theta) - (x_j - x_start) / scale|^2,
///
/// with tanh of both sides for bounded unknowns (Labelling),
/// then asked for the problems' unknowns. No selection of a best iterate.
/// Stage `fit`; arrays `weight_change`, `training_loss`.
#pragma once

#include <memory>

#include "baselines/regression.h"

namespace physinv {

std::shared_ptr<const Stage> supervised_fit(
    const RegressionOptions& options = {});

}  // namespace physinv
