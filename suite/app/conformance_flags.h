/// What `conformance` is asked. The verb and the program of the contract tests,
/// which it starts, read it alike.
#pragma once

#include <string>
#include <vector>

#include "suite/app/verbs.h"

namespace physinv {

struct ConformanceFlags {
  std::vector<std::string> filters;  ///< of experiments
  Arguments google;                  ///< GoogleTest's own
};

/// False if only the help was asked for. Throws UsageError.
bool parse_conformance(const Arguments& arguments, ConformanceFlags& flags);

}  // namespace physinv
