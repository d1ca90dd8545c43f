/// What a run of the toy fit records in addition to its losses: both
/// components, the hidden neurons, and the path of one point (HIG paper, Fig.
/// 1).
#pragma once

#include "optimizers/metrics.h"

namespace physinv::toy {

inline constexpr Index kHidden = 7;
/// The point whose path is drawn: both targets are large there.
inline constexpr double kPoint = 0.35;

/// Rows of the array `metrics`.
enum MetricRow : Index {
  kFirstLoss,   ///< half the mean square of the first component's residual
  kSecondLoss,  ///< of the second's
  kWeightNorm,  ///< 2-norm of theta
  kBeyond,      ///< share of hidden outputs beyond 0.99
  kPathFirst,   ///< z_1 at kPoint
  kPathSecond,  ///< z_2 there
  kMeans,       ///< of each neuron's output over the test points
  kDeviations = kMeans + kHidden,
  kMetricRows = kDeviations + kHidden
};

/// For the network 1-7-2 and the scaled output with factor gamma.
Metrics metrics(double gamma);

}  // namespace physinv::toy
