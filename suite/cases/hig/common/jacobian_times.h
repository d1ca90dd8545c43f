/// HIG paper, Tables 3 to 5: how long the Jacobian of an update takes. Adam's
/// is the gradient of the batch, that of half-inverse gradients the Jacobians
/// of solver and outputs; the network's own is never formed here. Updates of a
/// rate of zero take nothing else.
#pragma once

#include <string>
#include <string_view>

#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"

namespace physinv::hig {

/// "hig/oscillators-jacobians" of hig/oscillators, which is registered.
void add_jacobian_times(Registry& r, const std::string& experiment);
/// A method next to the row of the paper's table of "adam" or "hig" with this
/// batch, and what takes the Jacobian of the row.
CostLine cost_line(const std::string& experiment,
                   std::string_view optimizer,
                   Index batch,
                   std::string method,
                   std::string label);
void add_jacobian_report(Registry& r, const std::string& experiment);

}  // namespace physinv::hig
