/// Numbers of wave packets, in samples; `unit` is how many of them x counts as
/// one.
#pragma once

#include "suite/cases/jpo/common/values.h"

namespace physinv::jpo::wave_packet {

/// |t0 - truth|.
RunRow distances_in(double unit);
/// How much farther from the truth than BFGS.
RunRow farther_than_bfgs_in(double unit);
/// Length of the first step that is taken.
RunRow first_steps_in(double unit);

}  // namespace physinv::jpo::wave_packet
