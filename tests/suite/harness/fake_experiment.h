/// A small problem, methods that end in every way there is, and an experiment
/// of them.
#pragma once

#include "suite/harness/case.h"

namespace physinv::fake {

/// Methods: descend (one stage); walk and stroll (fit, refine; the same fit,
/// threads and random numbers in it); diverge; throws; exhaust (bad_alloc);
/// die (a signal); sleep (a minute); floats (leaves another rounding, subnormal
/// numbers that are zero); give-up, give-up-alone (throw after some calls);
/// breach (a broken contract); hostile (leaves what PHYSINV_FAKE_RETURN, a
/// number, says, such as estimates of another shape or counts that are none).
/// Profiles: smoke, quick (all that end well), bad (throws, exhaust, die, and
/// descend between them), hostile (and descend), slow, kernel (most of its time
/// is the physics').
///
/// PHYSINV_FAKE_PLANT names one defect to have: "ulp in the data", "ulp in a
/// constant", "more work", "NaN in a loss", "a case removed", "a kernel slower
/// by 10 %"; of descend and refine alone "larger losses", "an ulp in x", "no
/// finite loss", "an exception", "it converges", "gtol", "slower".
Experiment experiment();

}  // namespace physinv::fake
