/// A chain's losses over what it has spent, all stages joined.
#pragma once

#include <optional>
#include <vector>

#include "suite/store/record.h"

namespace physinv {

/// Calls of the simulator: a gradient, a Jacobian and an inverse count as one.
double simulations_of(const Counts& counts);

struct ConvergenceHistory {
  std::vector<double> seconds, simulations;
  std::vector<Vector<double>> loss;  ///< one entry per problem
  /// All that the chain spent, that of a stage that failed included; empty
  /// where that is not known because its process was lost.
  std::optional<double> all_seconds = {}, all_simulations = {};
  bool failed = false;  ///< one of the stages, so that the chain has no end
  /// `simulations` of a stage that counts them only at its end are spread
  /// evenly over its iterations.
  bool spread = false;
};

/// Empty unless every stage is finished, or one of them failed: of that one
/// and those behind it there are no points. A training that diverged ends with
/// an infinite loss. Where a method is judged by its network on a
/// test set and its curve is a mean (`mean_loss`), a problem is the whole run.
std::optional<ConvergenceHistory> history_of(const CaseRecord& found);

/// Whether a stage with these options looks instead of solving.
bool is_diagnostic(const Options& options);

}  // namespace physinv
