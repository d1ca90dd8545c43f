/// What runs of the heat experiment record in addition to their losses: errors
/// of x.
#pragma once

#include "optimizers/metrics.h"

namespace physinv::heat {

/// Rows of the array `metrics`. Errors are sum |x - x*| over the cells of an
/// example, means over the examples.
enum MetricRow : Index {
  kError,
  kClamped,  ///< of max(x, 0)
  /// Share of x*'s energy that x - x* has, in waves whose damping e^-s is above
  /// 1/e (without the mean), and in those from e^-4 to e^-16.
  kCoarse,
  kFine,
  // The same all along a run: what is reached without any solver.
  kOfMean,      ///< error of the mean of y
  kOfObserved,  ///< error of y itself
  kOfInverse,   ///< |e^s F y| over |x*|: the inverse that is not damped
  kMetricRows
};

Metrics metrics();

}  // namespace physinv::heat
