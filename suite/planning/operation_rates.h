/// Seconds of a counted operation: what is measured tells of what is not.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "suite/core/median.h"

namespace physinv {

/// What a case or a part of it did, and how long that took.
struct Work {
  double operations = 0, seconds = 0;
};

/// The median (median_high) of an experiment, else of its paper, else of all.
class OperationRates {
 public:
  /// Work of few operations is not taken: it is mostly what nobody counts.
  void add(const std::string& experiment, const Work& work) {
    constexpr double kFewOperations = 1e7;
    if (!(work.operations >= kFewOperations && work.seconds > 0)) return;
    for (const auto& key : keys(experiment))
      rates_[key].push_back(work.seconds / work.operations);
  }
  /// NaN if nothing is known.
  double seconds(const std::string& experiment, double operations) const {
    for (const auto& key : keys(experiment))
      if (const auto at = rates_.find(key); at != rates_.end())
        return operations * median_high(at->second);
    return std::numeric_limits<double>::quiet_NaN();
  }

 private:
  static std::vector<std::string> keys(const std::string& experiment) {
    return {experiment, experiment.substr(0, experiment.find('/') + 1), ""};
  }

  std::map<std::string, std::vector<double>> rates_;
};

}  // namespace physinv
