/// Methods that an experiment's author does not know: those in Python, which
/// their users add. Reports draw them next to the experiment's own.
#pragma once

#include <string>
#include <vector>

#include "suite/evidence/runs.h"

namespace physinv {

/// Methods with stages in the experiment that asks that are recorded as
/// Python's, failed ones too, in the order of the results.
std::vector<std::string> guests(const Evidence& evidence);

}  // namespace physinv
