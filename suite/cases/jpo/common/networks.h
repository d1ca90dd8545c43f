/// The networks of a registered experiment.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "suite/core/method.h"
#include "suite/core/network.h"

namespace physinv {

/// As its methods make it: `Setting::predictor` (from what it is given to the
/// unknowns) or `Setting::surrogate` (to the observations).
std::unique_ptr<Network<float>> network_of(const std::string& experiment,
                                           NetworkRole Setting::*role);

/// Names of the predictor's tensors, in the order of the records.
std::vector<std::string> tensor_names(const std::string& experiment);

}  // namespace physinv
