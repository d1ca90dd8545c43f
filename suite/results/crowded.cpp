#include "suite/results/crowded.h"

#include <fmt/format.h>

namespace physinv {

std::string crowded_text(const std::vector<CaseRecord>& cases) {
  std::size_t all = 0, crowded = 0;
  for (const CaseRecord& c : cases)
    for (const StageRecord& s : c.stages) ++all, crowded += s.crowded;
  if (crowded == 0) return "";
  return fmt::format(
      "{} of {} stages were crowded (wall time above {} times CPU time, more "
      "workers x threads than cores, or threads that changed): their wall "
      "times measure no speed, so tables use CPU time",
      crowded,
      all,
      kCrowdedFactor);
}

}  // namespace physinv
