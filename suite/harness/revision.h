/// Which revision of its sources a program or plug-in was linked from. It is in
/// a source that is written at build time (cmake/revision.cmake), so that the
/// program needs no git when it runs, and later changes of the sources do not
/// matter.
#pragma once

#include <string>
#include <string_view>

namespace physinv {

/// For static initialisation; returns true. `name`: of a program or plug-in
/// that was built on the installed suite (outside.h), empty for the suite's own
/// programs. `revision` ends in "+dirty" where a tracked file differed.
bool register_revision(std::string_view name, std::string_view revision);

/// "unknown" if the sources stood in no repository, and of programs that do not
/// tell (tests).
std::string revision_of(std::string_view name);

/// Of the program that runs.
std::string git_revision();

}  // namespace physinv
