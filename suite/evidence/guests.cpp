#include "suite/evidence/guests.h"

#include <algorithm>

#include "suite/results/results.h"

namespace physinv {
namespace {

bool in_python(const StageRecord& stage) {
  return std::any_of(
      stage.options.begin(), stage.options.end(), [](const auto& option) {
        return option.first == "algorithm" && option.second == "python";
      });
}

}  // namespace

std::vector<std::string> guests(const Evidence& evidence) {
  std::vector<std::string> found;
  for (const CaseRecord& c : evidence.results.cases())
    if (c.info.experiment == evidence.experiment &&
        std::any_of(c.stages.begin(), c.stages.end(), in_python) &&
        std::ranges::find(found, c.info.method) == found.end())
      found.push_back(c.info.method);
  return found;
}

}  // namespace physinv
