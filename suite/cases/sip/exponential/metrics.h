/// What a run of the exponential records in addition to its losses: errors of
/// x, over all of its range and over thirds of it, and how flat the network is.
#pragma once

#include "optimizers/metrics.h"

namespace physinv::exponential {

/// Rows of the array `metrics`; errors are |x - x*|.
enum MetricRow : Index {
  kMean,
  kLow,     ///< mean over x* in [-12, -8)
  kMiddle,  ///< [-8, -4)
  kHigh,    ///< [-4, 0]
  kLargest,
  kSpread,  ///< range of the estimates over x* < -9
  kRise,    ///< of the estimates from the lowest x* to that nearest to -3
  kMetricRows
};

Metrics metrics();

}  // namespace physinv::exponential
