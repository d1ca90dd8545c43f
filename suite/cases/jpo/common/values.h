/// What claims about the JPO paper's inverse problems are made of: runs by
/// their place in a chain, and numbers of one run, many of them compared with
/// plain BFGS on the same problems.
///
///   percent(mean(refined("jpo"), better()))            // Table 5
///   share_of_examples(bfgs(), largest_sets(if_solved(1e-6)), holds)
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "suite/cases/jpo/common/shares.h"
#include "suite/core/recipe.h"
#include "suite/evidence/condition.h"
#include "suite/evidence/run_values.h"
#include "suite/evidence/statistics.h"

namespace physinv::jpo {

Select bfgs();
Select gd();
/// Where a chain ends before its refinement: of a network, or of a solver, be
/// it on a surrogate.
Select plain(const std::string& method);
Select refined(const std::string& method);
/// Solvers by themselves have no refinement.
Select ending(const std::string& method, bool refined);
inline Select at(const Select& select, Index n) {
  return select.of_sizes(n, n);
}
/// The networks' chains, without their refinement and with it.
inline const Select kJpo = plain("jpo"), kRefined = refined("jpo"),
                    kSupervised = plain("supervised"),
                    kSupervisedRefined = refined("supervised"),
                    kAdjoint = plain("na"), kAdjointRefined = refined("na");
/// Plain BFGS on the same problems.
std::optional<Run> bfgs_beside(const Run& run);

// ---- numbers of one run ---------------------------------------------------

/// Shares of the run's problems: losses below BFGS's, equal to them bit by
/// bit, above them, and f = better + equal / 2.
RunValue better(Equality equality = Equality::strict);
RunValue equal(Equality equality = Equality::strict);
RunValue worse();
RunValue f(Equality equality = Equality::strict);
RunValue solved(const Solved& solved);
/// Share that it solves less the share that BFGS solves.
RunValue gain(const Solved& solved);
/// Of a refined run: mean share of the decrease that was made before.
/// With `from_prior` from the loss where BFGS starts, else from the untrained
/// network's.
RunValue decrease_before(bool from_prior = false);
/// Of a refined run: how many losses it increased.
RunValue worsened();
/// Over the run's problems; results.json keeps them of every stage.
RunValue mean_loss();
RunValue worst_loss();
/// The value over that of plain BFGS on the same problems.
RunValue over_bfgs(RunValue value);
/// Seconds of solving; none where the run shared its cores.
RunValue seconds();

// ---- a number of each problem ---------------------------------------------

/// 1 where it is solved, else 0.
RunRow if_solved(const Solved& solved);
/// Of the problems with `condition`, the values of `row`.
using Problems = std::function<bool(const Run&, Index)>;
RunRow where(Problems condition, RunRow row);
Problems is_solved(const Solved& solved);
/// What plain BFGS left unsolved.
Problems bfgs_unsolved(const Solved& solved);
/// First measured iteration with a loss below `loss`, infinite if there is
/// none: points of curves lie a seventh apart.
RunRow first_below(double loss);
/// Loss at the start of the run.
RunRow start_losses();
/// Of the problems whose paths are kept: unknown `j` at the last point and at
/// the first.
RunRow last_tracked(Index j);
RunRow first_tracked(Index j);
/// Of these problems, 1 where the last point lies outside the training
/// samples' range of any unknown or within `margin` of its ends, as a share of
/// the range; else 0. So many samples there are of each problem.
RunRow beyond_training(const ProblemRecipe& problem,
                       double margin,
                       Index per_problem = 1);

/// Sets of one seed are parts of each other; only the largest one counts.
RunRow largest_sets(RunRow row);
RunValue largest_sets(RunValue value);

/// For shares of rows of 0 and 1.
inline bool holds(double flag) { return flag > 0.5; }

// ---- over runs ------------------------------------------------------------

/// The mean over seeds at each n; of these the lowest, and the highest.
Quantity lowest_mean(const Select& select, const RunValue& value);
Quantity highest_mean(const Select& select, const RunValue& value);
/// Of the problems, on average over seeds.
Quantity percent_better(const Select& select);
/// `a` is better than BFGS in more of the problems than `b`.
Condition better_more_often(std::string label,
                            const Select& a,
                            const Select& b);
/// Of all their examples.
Quantity solved_share(const Select& select, const Solved& solved);
/// Missing unless the largest sets of `select` have so many problems.
Quantity from_problems(Index problems, const Select& select, Quantity q);
Quantity problem_count(const Select& select);

/// One row of Table 4 (refined: 5): better and equal as printed of so many
/// seeds.
std::vector<Condition> table4(const std::string& method, Index seeds);
std::vector<Condition> table5(const std::string& method, Index seeds);
/// Table 3 at n = 4, 8, 32, 128, all together.
std::vector<Condition> table3(Index seeds, bool from_prior = false);

}  // namespace physinv::jpo
