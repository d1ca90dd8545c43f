/// Results in the formats of other programs.
#pragma once

#include <string>

#include "suite/app/load.h"

namespace physinv {

/// A stored campaign as `json`, `csv`, `tidy`, `github` or `bencher`, with an
/// error for each stage that was not run. UsageError for another format.
std::string exported(const Loaded& loaded, const std::string& format);

}  // namespace physinv
