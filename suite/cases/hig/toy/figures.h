/// What a run of the toy fit shows beside its losses, and how it is drawn: the
/// hidden neurons and the path of one point (HIG paper, Fig. 1).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "suite/cases/hig/common/report.h"
#include "suite/cases/hig/toy/metrics.h"

namespace physinv::toy {

/// A metric at the last point at or before `updates`; median over seeds.
std::optional<double> median_metric(const Results& results,
                                    std::string_view experiment,
                                    std::string_view method,
                                    MetricRow row,
                                    Index updates);

/// Neurons whose output hardly varies over the test points any more
/// (standard deviation < 0.02), at the end of the runs.
struct Saturation {
  int neurons = 0, saturated = 0;
  int seeds = 0, seeds_with_one = 0;
  double share() const {
    return static_cast<double>(saturated) / static_cast<double>(neurons);
  }
};
std::optional<Saturation> saturation(const Results& results,
                                     std::string_view experiment,
                                     std::string_view method);

/// Mean and deviation of each neuron of one seed, a panel per method.
Figure neuron_figure(const Results& results,
                     std::string_view experiment,
                     const std::vector<MethodLine>& lines);
/// (z_1, z_2) of the point from the start to the end, one seed.
Figure path_figure(const Results& results,
                   std::string_view experiment,
                   const std::vector<MethodLine>& lines);
/// Median losses along the way, and what became of the neurons.
Table course_table(const Results& results,
                   std::string_view experiment,
                   const std::vector<MethodLine>& lines);

}  // namespace physinv::toy
