/// A chain's losses over what it has spent, all stages joined.
#pragma once

#include <optional>
#include <vector>

#include "suite/store/record.h"

namespace physinv {

struct ConvergenceHistory {
  std::vector<double> seconds, simulations;
  std::vector<Vector<double>> loss;  ///< one entry per problem
};

/// Empty unless every stage is finished, or one of them failed: that one and
/// those behind it are left out. Where a method is judged by its network on a
/// test set and its curve is a mean (`mean_loss`), a problem is the whole run.
std::optional<ConvergenceHistory> history_of(const CaseRecord& found);

/// Whether a stage with these options looks instead of solving.
bool is_diagnostic(const Options& options);

}  // namespace physinv
