/// Where the program finds what belongs to it, in a build tree and installed.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "suite/app/verbs.h"

namespace physinv {

/// The directory of the running program, symbolic links resolved.
std::filesystem::path program_directory();

/// The papers' numbers: what PHYSINV_PUBLISHED_DIR names, else what was
/// installed with the program, else the sources that it was built from, or the
/// installed suite that it was built on. The sources come last, so that an
/// installed program never depends on what is there now. Throws UsageError if
/// there are none.
std::filesystem::path published_directory();

/// Runs the program of this name, in the folder of this one, in place of this
/// process. EnvironmentError with what would make it if it cannot start.
[[noreturn]] void go_on_as(const std::string& name,
                           const Arguments& arguments,
                           std::string_view remedy);

}  // namespace physinv
