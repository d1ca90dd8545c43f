/// The networks of a registered experiment.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "suite/core/method.h"
#include "suite/core/network.h"
#include "suite/evidence/quantity.h"

namespace physinv {

/// As its methods make it: `Setting::predictor` (from what it is given to the
/// unknowns) or `Setting::surrogate` (to the observations).
std::unique_ptr<Network<float>> network_of(const std::string& experiment,
                                           NetworkRole Setting::*role);

/// Its number of parameters; of complex weights real and imaginary part are
/// two, or one.
Quantity parameters(const std::string& experiment,
                    NetworkRole Setting::*role = &Setting::predictor);
Quantity parameters_complex_once(const std::string& experiment);

/// Names of the predictor's tensors, in the order of the records.
std::vector<std::string> tensor_names(const std::string& experiment);

}  // namespace physinv
