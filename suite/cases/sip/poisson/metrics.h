/// What runs of the Poisson experiments record in addition to their losses:
/// errors of x, sums of |x - x*| over the cells, means over the examples (the
/// paper's "MAE").
#pragma once

#include "optimizers/metrics.h"
#include "optimizers/training/signal_recipe.h"

namespace physinv::poisson {

/// Rows of the array `metrics`.
enum MetricRow : Index { kError, kOfZero, kMetricRows };

Metrics metrics();

/// Over the batches of the last quarter of the updates; x* = L y.
LateError late_error(Index rows, Index columns);

}  // namespace physinv::poisson
