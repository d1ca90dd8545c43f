/// What truncation, projection and precision make of HIG on the dipole.
#pragma once

#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv::dipole {

/// Test loss after 256 updates, the lowest of all seeds, for each tau: in
/// float with the gradient projected and as it is, in double projected. The
/// paper: far below 1e-5 the network does not learn (claim P10: > 0.1).
Table tau_table(const Results& results);

}  // namespace physinv::dipole
