/// Tables and figures of the quantum dipole's experiments with a network.
#pragma once

#include "suite/results/published.h"
#include "suite/results/report_model.h"
#include "suite/results/results.h"

namespace physinv::dipole {

Section dense_report(const Results& results, const Published& published);
Section conv_report(const Results& results, const Published& published);

}  // namespace physinv::dipole
