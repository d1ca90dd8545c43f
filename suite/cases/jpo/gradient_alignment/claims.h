/// What Fig. 2 of the JPO paper claims, as conditions on measured shares.
#pragma once

#include <vector>

#include "suite/cases/jpo/gradient_alignment/shares.h"
#include "suite/results/report_model.h"

namespace physinv::alignment {

/// R2 to R6.
std::vector<ClaimResult> claims(const Fig2& f);

}  // namespace physinv::alignment
