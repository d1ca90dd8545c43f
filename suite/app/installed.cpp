#include "suite/app/installed.h"

#include <fmt/format.h>

#include "suite/harness/context.h"
#include "suite/harness/errors.h"
#include "suite/harness/outside.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

}  // namespace

fs::path program_directory() {
  return fs::read_symlink("/proc/self/exe").parent_path();
}

fs::path published_directory() {
  const fs::path named = variable("PHYSINV_PUBLISHED_DIR");
  const fs::path installed =
      (program_directory() / PHYSINV_INSTALLED_PUBLISHED).lexically_normal();
  const Outside* own = outside_program();
  const fs::path sources = own == nullptr ? PHYSINV_PUBLISHED_DIR
                                          : fs::path(own->data) / "published";
  const fs::path chosen = !named.empty()                ? named
                          : fs::is_directory(installed) ? installed
                                                        : sources;
  if (!fs::is_directory(chosen))
    throw UsageError(
        fmt::format("there is no directory '{}' of published numbers; "
                    "PHYSINV_PUBLISHED_DIR names it",
                    chosen.string()));
  return chosen;
}

}  // namespace physinv
