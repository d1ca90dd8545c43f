/// What runs of the quantum dipole's control without a network record.
#pragma once

#include "optimizers/metrics.h"

namespace physinv::dipole {

/// The first targets have angles 0.7 and 2.
inline constexpr Index kNamed = 2;
/// Rows of `losses_in_float`: the controls as the authors' precision sees
/// them, the worse loss of the two named targets by 1 - |<t, psi>|^2, and by
/// |psi - <t, psi> t|^2.
enum Formula : Index { kOverlap, kRest };
Metrics losses_in_float();

}  // namespace physinv::dipole
