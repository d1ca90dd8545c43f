/// The claims of registered experiments, judged.
#pragma once

#include "suite/harness/case.h"

namespace physinv {

/// In the order in which claims' `from` ranks them.
std::vector<std::string> profile_names(const Experiment& experiment);

std::vector<ClaimResult> judge(const Experiment& experiment,
                               const Results& results,
                               const Published& published);

}  // namespace physinv
