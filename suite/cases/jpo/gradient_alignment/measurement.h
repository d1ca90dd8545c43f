/// The stage that measures gradients and updates
/// (suite/diagnostics/alignment.h) on this experiment's noise.
#pragma once

#include <memory>
#include <optional>

#include "problems/noisy_absolute/noisy_absolute.h"
#include "suite/core/method.h"
#include "suite/diagnostics/one_step.h"

namespace physinv::alignment {

std::shared_ptr<const Stage> measurement(const NoisyAbsoluteOptions& data,
                                         std::optional<TinyNetOptions> network,
                                         Index repetitions,
                                         std::optional<double> clip = {});

}  // namespace physinv::alignment
