/// How runs of libraries ended: counts of the arrays that LibrarySolver leaves.
#pragma once

#include "suite/evidence/runs.h"
#include "suite/results/report_model.h"

namespace libraries {

/// A row for each method that was run, over its problems of all n and seeds:
/// how many they are; on how many it claims success, and on how many of these
/// an entry of the gradient is left above the experiment's gtol; on how many it
/// returned another point than the lowest that it evaluated, named a loss that
/// is not that of its point, spent its budget of evaluations, and evaluated
/// points outside of its bounds. The suite's own methods claim success by the
/// statuses `gtol` and `ftol` and record none of the rest.
physinv::Table ends_table(const physinv::Evidence& evidence);

}  // namespace libraries
