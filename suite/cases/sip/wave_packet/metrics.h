/// What a run of the SIP wave packet records in addition to its losses: how far
/// its estimates are from the true positions, in samples.
#pragma once

#include <numbers>

#include "optimizers/metrics.h"

namespace physinv::sip_wave_packet {

constexpr double kFrequency = 0.7;
/// Of the carrier, samples: minima of the loss are this far apart.
constexpr double kPeriod = 2 * std::numbers::pi / kFrequency;
/// Nearer to the truth than to any other minimum.
constexpr double kBasin = kPeriod / 2;

/// Rows of the array `metrics`.
enum MetricRow : Index {
  kMeanError,  ///< of |t0 - t0*|
  kMedianError,
  kWithinTwo,  ///< share of the examples
  kInBasin,
  kMetricRows
};

/// Of a problem whose unknown is t0 less a constant.
Metrics metrics();

}  // namespace physinv::sip_wave_packet
