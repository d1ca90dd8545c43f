/// What the experiments of the half-inverse-gradients paper share: test losses
/// of training stages, over updates and over time.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv {

/// The last stage of a method's chain for one seed, at the experiment's only
/// n; null if it is not there.
const StageRecord* trained_stage(const Results& results,
                                 std::string_view experiment,
                                 std::string_view method,
                                 std::uint64_t seed);

/// Mean test loss at the last point of the curve at or before `updates`
/// (the end of a run that diverged counts as infinite). Empty if the run is
/// not there or is shorter.
std::optional<double> test_loss(const StageRecord* stage, Index updates);

/// Median over the seeds there are; empty if there are none.
std::optional<double> median_test_loss(const Results& results,
                                       std::string_view experiment,
                                       std::string_view method,
                                       Index updates);

/// A method as a figure shows it.
struct MethodLine {
  std::string method, label, colour;
};

/// Median test loss over updates, and over solving time; the band is the range
/// over seeds.
Figure loss_figure(const Results& results,
                   std::string_view experiment,
                   const std::vector<MethodLine>& lines,
                   std::string id,
                   std::string title,
                   std::string source);

/// Per method: test loss at the end, seconds and bytes per update.
Table loss_table(const Results& results,
                 std::string_view experiment,
                 const std::vector<MethodLine>& lines);

}  // namespace physinv
