/// What a run of the sine records in addition to its losses: how far estimates
/// are from the nearest exact solution.
#pragma once

#include "optimizers/metrics.h"
#include "optimizers/training/signal_recipe.h"
#include "problems/sine_plane/sine_plane.h"

namespace physinv::sine {

/// Row of the array `metrics`: mean distance over the case's problems.
inline constexpr Index kDistance = 0;
Metrics metrics(const SinePlaneOptions& options);

/// Mean over a batch: the paper's score is its mean over the last tenth of the
/// updates.
LateError late_distance(const SinePlaneOptions& options);

}  // namespace physinv::sine
