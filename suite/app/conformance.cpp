#include <fmt/format.h>

#include "suite/app/conformance_flags.h"
#include "suite/app/installed.h"
#include "suite/harness/outside.h"

namespace physinv {

/// The other program loads the same plug-ins, by PHYSINV_PLUGINS.
ExitCode conformance_verb(const Arguments& arguments) {
  ConformanceFlags flags;
  if (!parse_conformance(arguments, flags)) return ExitCode::good;
  const Outside* own = outside_program();
  if (own == nullptr)
    go_on_as("physinv-conformance",
             arguments,
             "build the target physinv-conformance, or install it");
  go_on_as(fmt::format("{}_contract_test", own->name),
           arguments,
           fmt::format("physinv_add_contract_tests({}) builds it", own->name));
}

}  // namespace physinv
