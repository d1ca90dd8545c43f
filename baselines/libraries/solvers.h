/// What the plug-in's experiments have in common.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "suite/harness/registry.h"
#include "task.h"

namespace libraries {

/// The suite's BFGS and L-BFGS-B, and the solvers of all libraries.
std::vector<physinv::Method> solvers(const Task& task);
/// BFGS as in `base`, the others for as many iterations.
std::vector<physinv::Method> solvers(const physinv::Experiment& base);

/// BFGS with other first trials, and with two of them backing off at NaN, for
/// as many iterations as that of `base`.
std::vector<physinv::Method> bfgs_settings(const physinv::Experiment& base);

std::vector<std::string> ids(const std::vector<physinv::Method>& methods);

/// The experiment's profiles with those rows alone that run a method, each as
/// what `make` makes of it; without those that then have none.
std::vector<physinv::Profile> profiles_with(
    const physinv::Experiment& of,
    const char* method,
    const std::function<std::vector<physinv::Row>(const physinv::Profile&,
                                                  physinv::Row)>& make);

}  // namespace libraries
