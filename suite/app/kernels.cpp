#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "suite/app/installed.h"
#include "suite/app/verbs.h"

namespace physinv {

ExitCode kernels_verb(const Arguments& arguments) {
  std::string name = (program_directory() / "physinv-kernels").string();
  Arguments copies = arguments;
  std::vector<char*> argv = {name.data()};
  for (auto& a : copies) argv.push_back(a.data());
  argv.push_back(nullptr);
  execv(name.c_str(), argv.data());
  throw EnvironmentError(
      fmt::format("cannot start {} ({}); build the target physinv-kernels, or "
                  "install it",
                  name,
                  std::strerror(errno)));
}

}  // namespace physinv
