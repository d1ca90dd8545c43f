/// How fast methods reach a target: performance profiles (Dolan and More,
/// Math. Program. 91, 2002), time-to-target curves, and the same over many
/// targets (the runtime distributions of COCO).
///
/// A problem p is one example of one seed and one n. With f_L the lowest loss
/// that any method finds for it and f_0 the lowest loss at which any method
/// starts, it is solved to the tolerance tau (More and Wild, SIAM J. Optim.
/// 20, 2009) once
///
///   f <= f_L + tau (f_0 - f_L).
///
/// Where a method is judged by its network on a test set, whose curve is a mean
/// (`mean_loss`), a problem is one run: all methods from the same weights of
/// one seed.
///
/// The cost t(p, s) of method s is what its whole chain of stages has spent
/// when its curve first gets there, infinite if it never does.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "suite/evidence/common_runs.h"
#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv {

/// The lowest losses at which any method of a group starts, and that any finds.
struct LossRange {
  double start, lowest;
};

/// Empty if no method starts with a finite loss.
std::optional<LossRange> loss_range(const CommonRun& group, Index example);

/// Costs of one method, one entry per problem; infinite where it fails.
using Costs = std::vector<double>;

/// A function that grows in steps: y from x on. Ascending in both.
struct Steps {
  std::vector<double> x, y;
};

/// Of each method the costs over the best method's of each problem; infinite
/// where it fails, 1 for all that tie. Every method has the same problems,
/// costs are positive. A problem that all fail is infinite for all.
std::vector<Costs> performance_ratios(const std::vector<Costs>& costs);

/// Share of the values at most x, for each finite x there is. Values of
/// infinity never count and stay in the denominator.
Steps distribution(Costs values);

struct ProfileOptions {
  std::string title;  ///< of the experiment
  std::map<std::string, std::string> method_titles;
  std::vector<double> tolerances = {1e-2, 1e-5};
};

/// Costs of an experiment's methods at one tolerance.
struct TargetCosts {
  std::vector<std::string> methods = {};
  std::vector<Costs> seconds = {};  ///< the batch's time
  /// The batch's, over n; those of training if a problem is a run. At least 1.
  std::vector<Costs> simulations = {};
  /// The same, and of what is not solved all that its chain spent until its
  /// end or its failure; NaN where it is not known.
  std::vector<Costs> spent_seconds = {}, spent_simulations = {};
  bool runs = false;              ///< a problem is a run
  Index left_out = 0;             ///< methods beyond those that end lowest
  Index problems = 0;             ///< of every entry above
  Index solved_at_start = 0;      ///< left out: nothing to reach, or no number
  std::vector<Index> sizes = {};  ///< n of the cases compared
  Index seeds = 0;
  bool crowded = false;  ///< some stages shared their cores
};

/// Of one n, or of all.
TargetCosts target_costs(const CommonRuns& common,
                         double tolerance,
                         std::optional<Index> n = {});
TargetCosts target_costs(const Results& results,
                         const std::string& experiment,
                         double tolerance,
                         std::size_t most = 12);

/// Are there costs of more than the one simulation that each problem counts at
/// least? Otherwise an axis of simulations shows nothing.
bool any_simulated(const std::vector<Costs>& simulations);

/// A curve for each method: the share of its costs up to x. No curves if no
/// method has a finite cost.
Panel cost_panel(const std::vector<Costs>& values,
                 const std::vector<std::string>& methods,
                 const std::map<std::string, std::string>& titles);

/// Tolerances of the runtime distribution: 24, four to a decade.
std::vector<double> distribution_targets();

/// performance_profile and time_to_target: panels of seconds and, where
/// any are counted, of simulations per tolerance; runtime_distribution: all
/// targets together. If no two methods can be compared, the first two say why.
std::vector<Figure> performance_profile_figures(const CommonRuns& common,
                                                const ProfileOptions& options);
std::vector<Figure> performance_profile_figures(const Results& results,
                                                const std::string& experiment,
                                                const ProfileOptions& options);

}  // namespace physinv
