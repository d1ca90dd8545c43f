// Each folder of experiments by itself, as the program over it has it: what it
// registers is sound and has cases, and every name that its claims and reports
// ask for is there or known to be elsewhere. A process for each folder.
//
//   folders_alone_test [STORE-OF-SMOKE]   reports too, of the folder's records
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "suite/app/sections.h"
#include "suite/cases/common/folders.h"
#include "suite/harness/registry_errors.h"
#include "suite/results/results.h"

namespace physinv {
namespace {

/// As registration.cpp does it for the program over the folder.
void register_alone(const CaseFolder& folder) {
  std::vector<std::string> others;
  for (const CaseFolder& other : folders())
    if (other.path != folder.path)
      for (const std::string& name : other.experiments) others.push_back(name);
  name_elsewhere(std::move(others));
  folder.add(registry());
}

/// How many cases all profiles have.
std::size_t ask_registry() {
  const auto wrong = registry().problems();
  if (!wrong.empty())
    throw std::logic_error(fmt::format("{}", fmt::join(wrong, "; ")));
  std::size_t cases = 0;
  for (const std::string& profile : registry().profiles()) {
    const auto expanded = registry().expand(profile);
    validate(registry(), expanded);
    cases += expanded.size();
  }
  return cases;
}

/// How many sections the pages of the folder's own records have.
std::size_t ask_reports(const Results& smoke) {
  std::vector<CaseRecord> own;
  for (const CaseRecord& c : smoke.cases())
    if (registry().find(c.info.experiment)) own.push_back(c);
  return sections_of(Results(own), printed_numbers()).size();
}

bool ask(const CaseFolder& folder, const Results* smoke) {
  try {
    register_alone(folder);
    const std::size_t cases = ask_registry();
    const std::size_t sections = smoke == nullptr ? 0 : ask_reports(*smoke);
    fmt::print(
        "ok   {}: {} cases, {} sections\n", folder.path, cases, sections);
    return (cases > 0) != folder.experiments.empty();
  } catch (const std::exception& error) {
    fmt::print("FAIL {}: {}\n", folder.path, error.what());
    return false;
  }
}

bool ask_apart(const CaseFolder& folder, const Results* smoke) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    const bool good = ask(folder, smoke);
    std::fflush(stdout);
    _exit(good ? 0 : 1);
  }
  int status = 1;
  return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

/// A name that no folder has is an error in every program.
bool refuses_what_is_nowhere() {
  name_elsewhere({"hig/toy-gamma-*", "sip/heat"});
  return is_elsewhere("hig/toy-gamma-1") && is_elsewhere("sip/heat") &&
         !is_elsewhere("hig/toy") && !is_elsewhere("sip/heat-fno") &&
         !is_elsewhere("");
}

}  // namespace
}  // namespace physinv

int main(int argc, char** argv) {
  using namespace physinv;
  const Results smoke = argc > 1 ? load_results(argv[1]) : Results();
  bool good = refuses_what_is_nowhere();
  for (const CaseFolder& folder : folders())
    good = ask_apart(folder, argc > 1 ? &smoke : nullptr) && good;
  return good ? 0 : 1;
}
