/// Numbers among the options that a stage was recorded with.
#pragma once

#include <optional>
#include <string_view>

#include "suite/core/options.h"

namespace physinv {

/// Empty if there is no such option. Throws UnreadableInput if it is not a
/// number.
std::optional<double> number_of(const Options& options, std::string_view name);

}  // namespace physinv
