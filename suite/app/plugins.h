/// Plug-ins (physinv_add_plugin, docs/extending.md): shared objects that
/// register experiments, problems and methods in a program that runs.
#pragma once

#include "suite/app/verbs.h"

namespace physinv {

/// Loads what PHYSINV_PLUGINS names (with colons) and what flags --plugin=FILE
/// do, which are taken out of the arguments. Programs that this one starts find
/// them in PHYSINV_PLUGINS. UsageError for a file that is not a plug-in, is of
/// another build or registers a name that is there.
void load_plugins(Arguments& arguments);

}  // namespace physinv
