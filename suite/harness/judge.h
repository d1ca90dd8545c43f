/// The claims of registered experiments, judged.
#pragma once

#include "suite/harness/case.h"

namespace physinv {

class Registry;

/// In the order in which claims' `from` ranks them.
std::vector<std::string> profile_names(const Experiment& experiment);

/// The claims of an experiment, or of a paper's overview; none of what is not
/// registered.
std::vector<Claim> claims_of(const Registry& registry, const std::string& name);

std::vector<ClaimResult> judge(const Experiment& experiment,
                               const Results& results,
                               const Published& published);

}  // namespace physinv
