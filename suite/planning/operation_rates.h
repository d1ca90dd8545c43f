/// Seconds of a counted operation: what is measured tells of what is not.
#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace physinv {

/// What a case or a part of it did, and how long that took.
struct Work {
  double operations = 0, seconds = 0;
};

/// The median of an experiment, else of its paper, else of all.
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
        return operations * middle(at->second);
    return std::numeric_limits<double>::quiet_NaN();
  }

 private:
  static std::vector<std::string> keys(const std::string& experiment) {
    return {experiment, experiment.substr(0, experiment.find('/') + 1), ""};
  }
  static double middle(std::vector<double> values) {
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  }

  std::map<std::string, std::vector<double>> rates_;
};

}  // namespace physinv
