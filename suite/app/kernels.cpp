#include <fmt/format.h>
#include <fmt/ranges.h>

#include <sstream>

#include "suite/app/installed.h"
#include "suite/app/verbs.h"
#include "suite/harness/child.h"
#include "suite/harness/context.h"
#include "suite/harness/select.h"

namespace physinv {
namespace {

constexpr std::string_view kFilter = "--benchmark_filter=";

constexpr const char* kProgram = "physinv-kernels";
constexpr std::string_view kRemedy =
    "build the target physinv-kernels, or install it";

/// Google Benchmark's own expressions may take for ever. It gets the names
/// that match, each as it is.
std::string by_names(const std::string& pattern, std::string_view whose) {
  const NameFilter filter({pattern}, whose);
  const std::string program = (program_directory() / kProgram).string();
  const Ended listed = run_child(
      {program, "--benchmark_list_tests", std::string(kFilter) + "all"});
  if (listed.status != 0)
    throw EnvironmentError(fmt::format(
        "cannot start {} ({}); {}",
        program,
        listed.status < 0 ? "it does not exist" : "it cannot list its kernels",
        kRemedy));
  std::vector<std::string> names;
  std::istringstream lines(listed.output);
  for (std::string name; std::getline(lines, name);)
    if (!name.empty() && filter.matches(name)) names.push_back(exactly(name));
  if (names.empty())
    throw ExitError(
        ExitCode::nothing_matched,
        fmt::format(
            "no kernel matches '{}'; kernels --benchmark_list_tests lists all",
            pattern));
  return fmt::format("{}{}", kFilter, fmt::join(names, "|"));
}

/// The last filter counts, as with any of its flags; a flag goes before the
/// variable.
Arguments with_names(Arguments arguments) {
  std::string pattern = variable("BENCHMARK_FILTER");
  std::string_view whose = "BENCHMARK_FILTER";
  for (const auto& argument : arguments) {
    if (!argument.starts_with(kFilter)) continue;
    pattern = argument.substr(kFilter.size());
    whose = kFilter.substr(0, kFilter.size() - 1);
  }
  if (pattern.empty() || pattern == "all") return arguments;
  std::erase_if(arguments,
                [](const auto& a) { return a.starts_with(kFilter); });
  arguments.push_back(by_names(pattern, whose));
  return arguments;
}

}  // namespace

ExitCode kernels_verb(const Arguments& arguments) {
  go_on_as(kProgram, with_names(arguments), kRemedy);
}

}  // namespace physinv
