/// The toy fit for several gamma (HIG paper, Secs. 2.1, 2.2, Fig. 1), and what
/// became of its neurons.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "suite/cases/hig/toy/metrics.h"
#include "suite/evidence/training.h"
#include "suite/store/record.h"

namespace physinv::toy {

struct Gamma {
  double value;
  const char *experiment, *title;
};

inline constexpr std::array<Gamma, 3> kGammas = {
    {{1, "hig/toy-gamma-1", "Scaled output, gamma = 1"},
     {0.1, "hig/toy-gamma-0p1", "Scaled output, gamma = 0.1"},
     {0.01, "hig/toy-gamma-0p01", "Scaled output, gamma = 0.01"}}};

inline constexpr Index kUpdatesPerEpoch = 4;
/// A neuron whose output deviates less than this over the test points has
/// stopped to tell them apart.
inline constexpr double kSaturated = 0.02;

/// Of each hidden neuron, over the test points at the end of a run.
inline std::vector<double> last_deviations(const Run& run) {
  const Vector<double> neurons =
      run.stage->arrays.at("metrics").rightCols(1).middleRows(kDeviations,
                                                              kHidden);
  return {neurons.begin(), neurons.end()};
}

inline bool is_saturated(double deviation) { return deviation < kSaturated; }

inline RunValue saturated_neurons() {
  return [](const Run& run) {
    const auto all = last_deviations(run);
    return std::optional(static_cast<double>(
        std::count_if(all.begin(), all.end(), is_saturated)));
  };
}

}  // namespace physinv::toy
