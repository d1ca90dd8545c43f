/// Data one ulp off: repeating a run with them shows how many digits of its
/// results are stable.
#pragma once

#include <optional>

#include "suite/core/dataset.h"
#include "suite/core/options.h"

namespace physinv {

/// From now on in this process, the data of every problem are off by one unit
/// in the last place of this precision; without one, they are as drawn.
void disturb_data(std::optional<Precision> precision);

/// Every number that is not zero, away from zero, if that was asked for.
Samples<double> disturbed(Samples<double> drawn);

}  // namespace physinv
