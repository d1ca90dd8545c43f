#include "suite/app/plugins.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

#include "suite/harness/context.h"
#include "suite/harness/output.h"
#include "suite/harness/outside.h"
#include "suite/harness/registry.h"
#include "suite/store/file.h"

namespace physinv {
namespace {

constexpr std::string_view kMark = "physinv plug-in of build ";
constexpr std::string_view kFlag = "--plugin";

/// The files that flags name; takes the flags out.
std::vector<std::string> named_by_flags(Arguments& arguments) {
  std::vector<std::string> files;
  for (auto at = arguments.begin(); at != arguments.end();) {
    const bool apart = *at == kFlag;
    if (!apart && !at->starts_with(std::string(kFlag) + '=')) {
      ++at;
      continue;
    }
    if (apart) at = arguments.erase(at);
    const std::string file = at == arguments.end() ? ""
                             : apart               ? *at
                                     : at->substr(kFlag.size() + 1);
    if (file.empty()) throw UsageError("--plugin needs a file: --plugin=FILE");
    files.push_back(std::filesystem::absolute(file).string());
    at = arguments.erase(at);
  }
  return files;
}

/// What the file says of itself, before any of its code runs.
void check_build(const std::string& file) {
  if (!is_file(file))
    throw UsageError(fmt::format("there is no plug-in '{}'", file));
  const std::string bytes = read_file(file);
  const auto at = bytes.find(kMark);
  if (at == std::string::npos)
    throw UsageError(
        fmt::format("{} is not a plug-in built by physinv_add_plugin", file));
  const auto begin = at + kMark.size();
  const auto build = bytes.substr(begin, bytes.find('\0', begin) - begin);
  if (build != build_info().interfaces)
    throw UsageError(fmt::format(
        "{} was built with build {} of the suite, this is build {}; build it "
        "again with the headers installed with this program",
        file,
        one_line(build),
        build_info().interfaces));
}

/// Names that the plug-in was to have for itself.
void check_names(const std::string& file, std::size_t before) {
  std::set<std::string_view> plugins;
  for (const Outside& o : outsides())
    if (!plugins.insert(o.name).second)
      throw UsageError(
          fmt::format("{}: there are two plug-ins named {}", file, o.name));
  std::set<std::string> names;
  const auto& all = registry().experiments();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (!names.insert(all[i]->name).second && i >= before)
      throw UsageError(fmt::format(
          "{} registers {}, which already exists; give it another name",
          file,
          all[i]->name));
  if (const auto wrong = outside_problems(); !wrong.empty())
    throw UsageError(wrong.front());
}

void load_plugin(const std::string& file) {
  check_build(file);
  const std::size_t before = registry().experiments().size();
  if (dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL) == nullptr)
    throw UsageError(
        fmt::format("{} cannot be loaded: {}", file, one_line(dlerror())));
  check_names(file, before);
}

}  // namespace

void load_plugins(Arguments& arguments) {
  std::vector<std::string> files;
  std::istringstream named(variable("PHYSINV_PLUGINS"));
  for (std::string file; std::getline(named, file, ':');)
    if (!file.empty())
      files.push_back(std::filesystem::absolute(file).string());
  for (auto& file : named_by_flags(arguments))
    if (std::find(files.begin(), files.end(), file) == files.end())
      files.push_back(std::move(file));
  if (files.empty()) return;
  for (const auto& file : files) load_plugin(file);
  setenv(
      "PHYSINV_PLUGINS", fmt::format("{}", fmt::join(files, ":")).c_str(), 1);
}

}  // namespace physinv
