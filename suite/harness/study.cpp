#include "suite/harness/study.h"

#include "suite/core/check.h"

namespace physinv {
namespace {

std::map<std::string, std::string>& known() {
  static std::map<std::string, std::string> all;
  return all;
}

}  // namespace

const std::map<std::string, std::string>& studies() { return known(); }

bool register_study(const std::string& study, const std::string& varied) {
  SUITE_CHECK(study != varied && !studies().contains(varied),
              "a study varies an experiment that does not exist");
  const auto [at, first] = known().emplace(study, varied);
  SUITE_CHECK(first || at->second == varied,
              "a study varies one experiment: " + study);
  return true;
}

const std::string& streams_of(const std::string& experiment) {
  const auto found = studies().find(experiment);
  return found == studies().end() ? experiment : found->second;
}

Rng root_of(const std::string& experiment, std::uint64_t seed) {
  return Rng::root(streams_of(experiment), seed);
}

}  // namespace physinv
