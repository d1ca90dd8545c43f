/// What the figures of the oscillators claim (Figs. 2, 12, 13), as conditions
/// on test losses.
#pragma once

#include <vector>

#include "suite/results/published.h"
#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv::oscillators {

/// A1 to A7.
std::vector<ClaimResult> claims(const Results& results,
                                const Published& published);

}  // namespace physinv::oscillators
