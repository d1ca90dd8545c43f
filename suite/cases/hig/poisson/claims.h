/// Claims of HIG paper Figs. 3, 7, Table 4.
#pragma once

#include <vector>

#include "suite/cases/hig/poisson/runs.h"
#include "suite/results/report_model.h"

namespace physinv::poisson {

/// Assertions 1 to 9.
std::vector<ClaimResult> claims(const Runs& runs);

}  // namespace physinv::poisson
