#include "suite/app/gate_flags.h"

#include <cstdlib>

#include "suite/app/installed.h"
#include "suite/app/options.h"
#include "suite/harness/context.h"

namespace physinv {

std::vector<Case> cases_of(const Chosen& chosen,
                           const std::vector<std::string>& filters) {
  registry().validate();
  auto all = registry().expand(chosen.profile,
                               parse_overrides(chosen.sets, chosen.seeds));
  return NameFilter(filters).apply(
      NameFilter(chosen.filters).apply(std::move(all)));
}

int jobs_or_cores(int jobs) { return jobs > 0 ? jobs : available_cores(); }

std::filesystem::path counting_program() {
  const char* named = std::getenv("PHYSINV_COUNT");
  return named != nullptr ? std::filesystem::path(named)
                          : program_directory() / "physinv-count";
}

}  // namespace physinv
