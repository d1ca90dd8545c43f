/// Gating claims that are known not to hold, from a reviewed list:
///
///   {"expected": [{"experiment": "jpo/arm", "claim": "R3", "reason": "..."}]}
///
/// Without a reason, the claim's own cause is it. An entry may name the one
/// "profile" in which the claim misses. What differs, depends or contradicts
/// itself is explained by its claim and stands in no list.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "suite/harness/registry.h"
#include "suite/results/report_model.h"

namespace physinv {

struct ExpectedFailure {
  std::string experiment, claim, reason, profile;
};

/// UsageError, naming the file and the entry, if it is malformed.
std::vector<ExpectedFailure> read_expected(const std::filesystem::path& path);

/// Those of experiments and papers that are registered: the suite's list serves
/// programs that have other experiments.
std::vector<ExpectedFailure> known_to(const Registry& registry,
                                      std::vector<ExpectedFailure> expected);

/// UsageError if an entry names no claim, or has no reason and its claim no
/// cause. An experiment that declares none may make its claims while it
/// reports: they are known once it has run.
void check_expected(const std::vector<ExpectedFailure>& expected,
                    const Registry& registry,
                    const std::vector<Section>& sections,
                    const std::filesystem::path& path);

/// Gating claims, as "experiment id: sentence"; for known misses the reason,
/// for those that their cause explains verdict and cause.
struct ClaimTally {
  std::size_t judged = 0;
  std::vector<std::string> misses, known_misses, explained;
  std::vector<std::string> surprises;  ///< listed, and hold
  std::vector<std::string> stale;      ///< hold, with the cause that says not
};
ClaimTally compare(const std::vector<Section>& sections,
                   const std::vector<ExpectedFailure>& expected,
                   const std::string& profile);

/// How many gating claims are decided by runs of these results, and not by what
/// is registered alone, such as a network's number of parameters. Claims that
/// an experiment makes while it reports count as decided by runs.
std::size_t decided_by_runs(const Registry& registry,
                            const std::vector<Section>& sections,
                            const Results& results,
                            const Published& published);

}  // namespace physinv
