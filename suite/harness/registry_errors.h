/// What is wrong with what is registered. All of it is looked through once per
/// build, by a test; a start of the program looks at what it will run.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "suite/harness/registry.h"

namespace physinv {

/// The lines of `Registry::problems` about the experiments of these cases, and
/// about experiments of the same name; throws std::logic_error with them, if
/// any.
void validate(const Registry& registry, const std::vector<Case>& cases);

/// Experiments that this program leaves out; one that ends with a star stands
/// for all that begin so. Claims may ask for runs of them: they are not there,
/// and checked in the program over all. Replaces those named before.
void name_elsewhere(std::vector<std::string> experiments);
bool is_elsewhere(std::string_view experiment);

}  // namespace physinv
