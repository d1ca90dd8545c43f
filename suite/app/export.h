/// Results in the formats of other programs.
#pragma once

#include <string>

namespace physinv {

/// A stored campaign as `json`, `csv`, `github` or `bencher`. UsageError for
/// another format or no results.
std::string exported(const std::string& directory, const std::string& format);

}  // namespace physinv
