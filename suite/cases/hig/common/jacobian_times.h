/// HIG paper, Tables 3 to 5: how long the Jacobian of an update takes. Adam's
/// is the gradient of the batch, that of half-inverse gradients the Jacobians
/// of solver and outputs; the network's own is never formed here. Updates of a
/// rate of zero take nothing else.
#pragma once

#include <string>

#include "suite/evidence/runs.h"
#include "suite/harness/registry.h"

namespace physinv::hig {

/// "hig/oscillators-jacobians" of hig/oscillators, which is registered.
void add_jacobian_times(Registry& r, const std::string& experiment);
/// Its runs: Adam's gradient of a batch, the Jacobians of half-inverses.
Select gradient_of(const std::string& experiment, Index batch);
Select jacobians_of(const std::string& experiment, Index batch);
void add_jacobian_report(Registry& r, const std::string& experiment);

}  // namespace physinv::hig
