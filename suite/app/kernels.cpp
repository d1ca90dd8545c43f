#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "suite/app/verbs.h"

namespace physinv {

ExitCode kernels_verb(const Arguments& arguments) {
  const auto program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() /
      "physinv-kernels";
  std::string name = program.string();
  Arguments copies = arguments;
  std::vector<char*> argv = {name.data()};
  for (auto& a : copies) argv.push_back(a.data());
  argv.push_back(nullptr);
  execv(name.c_str(), argv.data());
  throw EnvironmentError(
      fmt::format("cannot start {} ({}); build the target physinv-kernels",
                  name,
                  std::strerror(errno)));
}

}  // namespace physinv
