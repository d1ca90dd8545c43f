/// Claims that are known not to hold, from a reviewed list:
///
///   {"expected": [{"experiment": "jpo/arm", "claim": "R3", "reason": "..."}]}
///
/// An entry may name the one "profile" in which the claim misses.
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

/// UsageError if an entry names no claim. An experiment that declares none
/// may make its claims while it reports: they are known once it has run.
void check_expected(const std::vector<ExpectedFailure>& expected,
                    const Registry& registry,
                    const std::vector<Section>& sections,
                    const std::filesystem::path& path);

/// Gating claims, as "experiment id: sentence"; for known misses the reason.
struct ClaimTally {
  std::size_t judged = 0;
  std::vector<std::string> misses, known_misses;
  std::vector<std::string> surprises;  ///< listed, and hold
};
ClaimTally compare(const std::vector<Section>& sections,
                   const std::vector<ExpectedFailure>& expected,
                   const std::string& profile);

}  // namespace physinv
