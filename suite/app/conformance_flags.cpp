#include "suite/app/conformance_flags.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "suite/app/flags.h"

namespace physinv {
namespace {

constexpr std::string_view kPrefix = "--gtest_";
constexpr const char* kGoogle[] = {"break_on_failure",
                                   "catch_exceptions",
                                   "fail_fast",
                                   "filter",
                                   "list_tests",
                                   "output",
                                   "repeat",
                                   "shuffle"};

void check_google(const std::string& argument) {
  const std::string name =
      argument.substr(kPrefix.size(), argument.find('=') - kPrefix.size());
  if (std::ranges::find(kGoogle, name) == std::end(kGoogle))
    throw UsageError(
        fmt::format("conformance has no flag {}{}; it accepts these flags of "
                    "GoogleTest: {}",
                    kPrefix,
                    name,
                    fmt::join(kGoogle, ", ")));
}

}  // namespace

bool parse_conformance(const Arguments& arguments, ConformanceFlags& flags) {
  Arguments own;
  for (const auto& argument : arguments) {
    const bool google = argument.starts_with(kPrefix);
    if (google) check_google(argument);
    (google ? flags.google : own).push_back(argument);
  }
  return parse(
      "conformance",
      "Runs the contract tests for everything that plug-ins register or, "
      "without plug-ins, the program. They check derivatives against "
      "differences and each other, forward and linearize bit by bit, batches "
      "against their samples, no effect of a NaN on other samples, budgets, "
      "repetition, records and claims. Prints a line for each check. Flags of "
      "GoogleTest, such as --gtest_filter and --gtest_output, are passed on. "
      "Exit 4 if a check fails, 3 if nothing matched.",
      {{.name = "FILTER",
        .help = "regular expressions of experiments",
        .to = &flags.filters,
        .optional = true}},
      own);
}

}  // namespace physinv
