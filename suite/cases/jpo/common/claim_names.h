/// Names of the JPO paper's claims: those of values.h, under the same names.
#pragma once

#include "suite/cases/common/claims.h"
#include "suite/cases/jpo/common/values.h"

namespace physinv::jpo {

/// The suite's names, and the paper's: runs (jpo, jpo_refined, supervised,
/// adjoint, bfgs, gradient_descent, ...), values of a run (better, f,
/// solved(1e-6), ...) and of each problem (if_solved(1e-6), ...). What asks for
/// a loss below which a problem is solved takes a `Solved` as well.
ClaimNames claim_names();

}  // namespace physinv::jpo
