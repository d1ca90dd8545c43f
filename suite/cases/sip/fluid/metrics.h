/// What runs of the fluid experiments record in addition to their losses: means
/// over the examples.
#pragma once

#include "optimizers/metrics.h"

namespace physinv::fluid_case {

/// Rows of the array `metrics`:
///
///   kError   |x - x*| at the cells, their mean
///   kVortex  |s(x) - s(x*)|, s the strength of the vortex
///   kLarge   error of x* without its small scales
enum MetricRow : Index { kError, kVortex, kLarge, kMetricRows };

Metrics metrics();

/// Mean over cells and examples of the length of a field (component, cell).
double mean_length(BatchIn<double> field);

}  // namespace physinv::fluid_case
