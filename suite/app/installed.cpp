#include "suite/app/installed.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "suite/harness/context.h"
#include "suite/harness/errors.h"
#include "suite/harness/outside.h"
#include "suite/store/file.h"

namespace physinv {

namespace fs = std::filesystem;

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
  const fs::path chosen = !named.empty()         ? named
                          : is_folder(installed) ? installed
                                                 : sources;
  if (!is_folder(chosen))
    throw UsageError(
        fmt::format("there is no directory '{}' of published numbers; set "
                    "PHYSINV_PUBLISHED_DIR to it",
                    chosen.string()));
  return chosen;
}

void go_on_as(const std::string& name,
              const Arguments& arguments,
              std::string_view remedy) {
  std::string program = (program_directory() / name).string();
  Arguments copies = arguments;
  std::vector<char*> argv = {program.data()};
  for (auto& a : copies) argv.push_back(a.data());
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  throw EnvironmentError(fmt::format(
      "cannot start {} ({}); {}", program, std::strerror(errno), remedy));
}

}  // namespace physinv
