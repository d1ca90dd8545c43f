/// What is wrong with what is registered. All of it is looked through once per
/// build, by a test; a start of the program looks at what it will run.
#pragma once

#include <vector>

#include "suite/harness/registry.h"

namespace physinv {

/// The lines of `Registry::problems` about the experiments of these cases, and
/// about experiments of the same name; throws std::logic_error with them, if
/// any.
void validate(const Registry& registry, const std::vector<Case>& cases);

}  // namespace physinv
