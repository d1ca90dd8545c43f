/// What an update of a training takes, as tables of times tell it.
#pragma once

#include <algorithm>
#include <vector>

#include "suite/evidence/cell.h"
#include "suite/evidence/statistics.h"
#include "suite/store/record.h"

namespace physinv {

/// CPU milliseconds, the median over the runs.
inline Cell update_time(const Evidence& evidence,
                        const Select& runs,
                        TimedStages& timed) {
  const auto all = find_runs(evidence, runs);
  if (all.empty()) return {.text = kNotRun};
  std::vector<double> milliseconds;
  for (const Run& run : all)
    if (const auto seconds = timed.seconds(*run.stage))
      milliseconds.push_back(
          1e3 * *seconds /
          static_cast<double>(std::max<Index>(1, run.stage->iterations)));
  if (milliseconds.empty()) return {.text = kCrowded};
  return written(median(milliseconds));
}

}  // namespace physinv
