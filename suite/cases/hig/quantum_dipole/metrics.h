/// What runs of the quantum dipole record in addition to their losses.
#pragma once

#include "optimizers/metrics.h"

namespace physinv::dipole {

/// Rows of `levels`: losses of the first and of the second excited state alone
/// (LE and HE of Fig. 4c), means over the test set.
enum Level : Index { kLow, kHigh };
Metrics levels();

/// The first targets of a control without a network have angles 0.7 and 2.
inline constexpr Index kNamed = 2;
/// Rows of `losses_in_float`: the controls as the authors' precision sees
/// them, the worse loss of the two named targets by 1 - |<t, psi>|^2, and by
/// |psi - <t, psi> t|^2.
enum Formula : Index { kOverlap, kRest };
Metrics losses_in_float();

}  // namespace physinv::dipole
