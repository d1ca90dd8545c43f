/// Numbers of runs of the SIP wave packet, for its claims and tables. Positions
/// are in samples; the start of L-BFGS-B is 0.
#pragma once

#include <limits>

#include "suite/cases/sip/wave_packet/metrics.h"
#include "suite/evidence/run_values.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training.h"

namespace physinv::sip_wave_packet {

/// |t0 - t0*| of the examples that lie from `from` on and before `to` away from
/// the start.
RunRow errors(double from = 0,
              double to = std::numeric_limits<double>::infinity());
/// How far from the start they end.
RunRow moves(double from = 0);
/// How far |t0 - t0*| is from whole periods.
RunRow off_period();
/// The same for those that lie so far from the start and have missed by a
/// period at least; infinite for those that have not.
RunRow off_missed_period(double from, double to);
/// (L - L') / L', L' that of L-BFGS-B on the same example.
RunRow loss_over_lbfgs();

/// The share of the examples within half a period of the truth.
RunValue in_basin();
/// Updates until the mean loss, or the mean error, has fallen below that of
/// L-BFGS-B; infinite if never.
RunValue passes_lbfgs();
RunValue passes_lbfgs_error();

}  // namespace physinv::sip_wave_packet
