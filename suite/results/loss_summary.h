/// Mean, median and largest loss of a stage: what results.json keeps of all.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "suite/store/record.h"

namespace physinv {

struct LossSummary {
  double mean, median, largest;
};

/// Where a stage that was read from results.json has them, in that order.
inline constexpr ArrayKey kLossSummary{"losses"};

inline void keep(const LossSummary& losses, StageRecord& stage) {
  Batch<double> kept(3, 1);
  kept << losses.mean, losses.median, losses.largest;
  stage.arrays[kLossSummary] = std::move(kept);
}

/// A loss that is not finite is infinite.
inline double finite_or_infinite(double loss) {
  return std::isfinite(loss) ? loss : std::numeric_limits<double>::infinity();
}

/// As it was kept, or of all losses; of none there is none. Infinite if one of
/// them is not finite.
inline std::optional<double> mean_loss_of(const StageRecord& stage) {
  if (const auto at = stage.arrays.find(kLossSummary); at != stage.arrays.end())
    return finite_or_infinite(at->second(0));
  const auto& all = stage.loss;
  if (all.size() == 0) return {};
  return finite_or_infinite(std::accumulate(all.begin(), all.end(), 0.0) /
                            static_cast<double>(all.size()));
}
inline std::optional<double> largest_loss_of(const StageRecord& stage) {
  if (const auto at = stage.arrays.find(kLossSummary); at != stage.arrays.end())
    return finite_or_infinite(at->second(2));
  const auto& all = stage.loss;
  if (all.size() == 0) return {};
  double largest = -std::numeric_limits<double>::infinity();
  for (const double loss : all)
    largest = std::max(largest, finite_or_infinite(loss));
  return largest;
}

}  // namespace physinv
