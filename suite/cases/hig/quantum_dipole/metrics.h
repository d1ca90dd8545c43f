/// What runs of the quantum dipole record beside their losses.
#pragma once

#include "optimizers/metrics.h"

namespace physinv::dipole {

/// Rows of `levels`: losses of the first and of the second excited state alone
/// (LE and HE of Fig. 4c), means over the test set.
enum Level : Index { kLow, kHigh };
Metrics levels();

}  // namespace physinv::dipole
