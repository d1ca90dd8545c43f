/// A library's minimizer as a stage of a method.
#pragma once

#include <functional>
#include <memory>

#include "library_solver.h"
#include "suite/core/method.h"
#include "task.h"

namespace libraries {

struct LibraryFacts {
  physinv::Options options;  ///< what decides the numbers, library and version
  Task task;
};

/// Stage `solve`: the library on the true losses from the start, once for each
/// problem. `make` gives it for the experiment's gtol. Arrays and message are
/// those of LibrarySolver. `source`: where the library's adapter is written.
std::shared_ptr<const physinv::Stage> library_solve(
    LibraryFacts facts,
    std::function<Library(double gtol)> make,
    const char* source = __builtin_FILE());

}  // namespace libraries
