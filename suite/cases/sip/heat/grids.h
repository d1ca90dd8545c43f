/// The studies of training with SIP and with Adam: batches and rates (Fig. 11),
/// finite training sets (Fig. 12).
#pragma once

#include <iterator>
#include <string>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/power_of_ten.h"

namespace physinv::heat {

inline constexpr const char* kName = "sip/heat";
/// The same with a Fourier neural operator.
inline constexpr const char* kOperator = "sip/heat-fno";

inline constexpr Index kSide = 64;  ///< cells

inline constexpr Index kBatches[] = {4, 32, 128};

/// One setting; the paper's own has no suffix.
struct GridPoint {
  Index batch = 128;
  int decade = 3;  ///< the rate is 10^-decade
  Index set = 0;   ///< samples of the training set; 0: always fresh ones

  double rate() const { return math::power_of_ten(-decade); }
  /// "sip-t512-b32", "adam-b4-lr2"
  std::string id(std::string method) const {
    if (set > 0) method += "-t" + std::to_string(set);
    if (set > 0 || batch != 128) method += "-b" + std::to_string(batch);
    if (decade != 3) method += "-lr" + std::to_string(decade);
    return method;
  }
};

/// Rates of 1e-2, 1e-3 and 1e-4 with each batch.
inline std::vector<GridPoint> rates_with(const std::vector<Index>& batches) {
  std::vector<GridPoint> all;
  for (const int decade : {2, 3, 4})
    for (const Index batch : batches) all.push_back({batch, decade});
  return all;
}

inline std::vector<GridPoint> rate_points() {
  return rates_with({std::begin(kBatches), std::end(kBatches)});
}

inline std::vector<GridPoint> set_points() {
  std::vector<GridPoint> all;
  for (const Index set : {32, 128, 512, 2048})
    for (const Index batch : kBatches) all.push_back({batch, 3, set});
  return all;
}

/// The smallest set, whose training error is recorded, too.
inline constexpr GridPoint kGap{.batch = 8, .set = 32};

}  // namespace physinv::heat
