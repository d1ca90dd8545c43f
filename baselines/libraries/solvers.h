/// What the plug-in's experiments have in common.
#pragma once

#include <string>
#include <vector>

#include "suite/harness/registry.h"

namespace libraries {

/// BFGS as in `base`, the suite's L-BFGS-B, and the solvers of all libraries,
/// for as many iterations.
std::vector<physinv::Method> solvers(const physinv::Experiment& base);

std::vector<std::string> ids(const std::vector<physinv::Method>& methods);

/// Does the row run it?
bool has(const physinv::Row& row, const char* method);

}  // namespace libraries
