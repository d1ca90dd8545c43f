/// Tables of the Poisson experiment.
#pragma once

#include "suite/cases/hig/poisson/runs.h"
#include "suite/results/report_model.h"

namespace physinv::poisson {

/// Kept singular values and the smallest of them, by method, in phases by HIG
/// and Gauss-Newton.
Table spectrum_table(const Runs& runs);

/// Where the curves of Adam's rates cross, over updates.
Table crossing_table(const Runs& runs);

}  // namespace physinv::poisson
