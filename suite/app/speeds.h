/// How fast this machine is, for the verbs that plan.
#pragma once

#include "suite/planning/trials.h"

namespace physinv {

/// Those that the user's cache keeps; a line on standard error if it cannot.
Trials known_speeds();

}  // namespace physinv
