/// Properties of the sine problems of a record, for any method.
#pragma once

#include "problems/sine_plane/sine_plane.h"
#include "suite/evidence/runs.h"

namespace physinv::sine {

/// Largest minus smallest value of the recorded solutions' widest unknown.
RunValue solution_range();

/// Steps from the solution of another problem, the next one of the record:
/// highest slope of the loss along a step of SIP, and the share of plain
/// Newton steps along which it rises.
RunValue highest_slope(const SinePlaneOptions& options);
RunValue newton_ascents(const SinePlaneOptions& options);

/// Largest distance of an observation from that of its nearest solution.
RunValue residual(const SinePlaneOptions& options);
/// Share of the problems whose first observation is beyond `most`.
RunValue share_beyond(double most);

}  // namespace physinv::sine
