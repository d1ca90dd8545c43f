/// Fig. 15 of the SIP paper: what an update of each experiment takes.
#pragma once

#include "suite/results/published.h"
#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv::sip::overview {

/// A table of CPU times, experiment by method, and curves over the batch.
Section step_times(const Results& results, const Published& published);

}  // namespace physinv::sip::overview
