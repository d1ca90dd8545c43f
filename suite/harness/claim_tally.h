/// Verdicts of the gating claims of a report, for `report --check`. A claim
/// that fails and states why (`Fails:` in claims.md) is known to; what differs,
/// depends or contradicts itself is explained by its cause.
#pragma once

#include <string>
#include <vector>

#include "suite/harness/registry.h"
#include "suite/results/report_model.h"

namespace physinv {

/// "jpo/arm R3, jpo/billiards P1": claims that may fail without a cause.
/// UsageError if one of them is not a claim of the registry or of the sections.
std::vector<std::string> expected_to_fail(const std::string& names,
                                          const Registry& registry,
                                          const std::vector<Section>& sections);

/// Gating claims, as "experiment id: sentence"; for known misses the cause, for
/// those that their cause explains verdict and cause.
struct ClaimTally {
  std::size_t judged = 0;
  std::vector<std::string> misses, known_misses, explained;
  std::vector<std::string> surprises;  ///< expected to fail, and hold
  std::vector<std::string> stale;      ///< hold, with the cause that says not
};
ClaimTally tally(const std::vector<Section>& sections,
                 const std::vector<std::string>& expected);

/// How many gating claims are decided by runs of these results, and not by what
/// is registered alone, such as a network's number of parameters. Claims that
/// an experiment makes while it reports count as decided by runs.
std::size_t decided_by_runs(const Registry& registry,
                            const std::vector<Section>& sections,
                            const Results& results,
                            const Published& published);

}  // namespace physinv
