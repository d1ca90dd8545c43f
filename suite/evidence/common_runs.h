/// The chains of an experiment's methods on the same problems: those of each n
/// and seed at which all methods are finished.
#pragma once

#include <string>
#include <vector>

#include "suite/evidence/convergence_history.h"
#include "suite/results/results.h"

namespace physinv {

/// Of one n and seed.
struct CommonRun {
  Index n = 0, examples = 0;  ///< examples: problems of each history
  std::vector<ConvergenceHistory>
      histories;  ///< of each method; no points if it failed at once
};

struct CommonRuns {
  std::vector<std::string> methods;
  Index left_out = 0;  ///< methods beyond those that end lowest
  std::vector<CommonRun> groups;
  /// A problem is a run: methods are judged by their network on a test set.
  bool runs = false;
  std::vector<Index> sizes;  ///< n of the cases
  Index seeds = 0;
  bool crowded = false;  ///< some stages shared their cores
};

/// Of problem i at the end of a chain; infinite where it failed or where the
/// loss is not finite.
double final_loss(const ConvergenceHistory& history, Index i);

/// Of an experiment's methods the `most` whose mean final losses are lowest, in
/// the order of the results.
std::vector<std::string> lowest_methods(const Results& results,
                                        const std::string& experiment,
                                        std::size_t most);

/// A failed stage ends its chain, which counts: as unsolved, with what it spent
/// and an infinite loss at its end. Of many methods, the `most` that end
/// lowest.
CommonRuns common_runs(const Results& results,
                       const std::string& experiment,
                       std::size_t most = 12);

}  // namespace physinv
