/// How fast this machine is, for the verbs that plan.
#pragma once

#include <vector>

#include "suite/planning/predict.h"
#include "suite/planning/trials.h"

namespace physinv {

/// Those that the user's cache keeps; a line on standard error if it cannot.
Trials known_speeds();

/// What published campaigns took: durations.csv, in the folder of the papers'
/// numbers.
std::filesystem::path durations_file();

/// Of these cases, see forecast; nothing is run.
std::vector<Cost> costs_without_runs(const std::vector<Case>& cases);

}  // namespace physinv
