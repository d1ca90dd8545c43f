/// What every experiment shows of all its methods, also those of users: how
/// much they solve with a budget, and their losses along it.
#pragma once

#include <map>
#include <string>

#include "suite/evidence/common_runs.h"
#include "suite/evidence/performance_profiles.h"
#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv {

/// Share of problems solved to tau = 1e-5 (performance_profiles.h) after a
/// number of simulations, of seconds where nothing is simulated; a panel for
/// each of up to four n. No panels if no two methods can be compared.
Figure solved_by_budget(const CommonRuns& common,
                        const ProfileOptions& options);

/// Mean losses of whole chains over the same, median and 10 %
/// and 90 % quantiles over seeds; a panel for each of up to four n, a curve for
/// each method with runs. Of more than 24 methods, those in Python and those
/// that end lowest.
Figure learning_curves(const Results& results,
                       const std::string& experiment,
                       const ProfileOptions& options);

}  // namespace physinv
