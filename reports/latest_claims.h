/// The verdict on each claim, from the published campaigns.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "reports/digest.h"
#include "suite/results/verdict_words.h"

namespace physinv {

struct LatestClaim {
  ClaimResult claim;
  std::string campaign;
  std::int64_t cases = 0;  ///< behind what was decided
};
/// Experiment and id; ids by their number, P2 before P10.
using ClaimKey = std::pair<std::string, std::string>;
struct ByNumber {
  bool operator()(const ClaimKey& a, const ClaimKey& b) const;
};
using LatestClaims = std::map<ClaimKey, LatestClaim, ByNumber>;
/// By the key of the paper.
using Papers = std::map<std::string, LatestClaims>;

/// By their dates, the newest first; as they are where dates are equal.
std::vector<NamedDigest> newest_first(std::vector<NamedDigest> campaigns);

/// The newest campaign that decided a claim counts, whatever it is called; not
/// one that ran fewer of the claim's cases than an older one. What was decided
/// counts before what was judged in part, and that before what was only
/// reported.
Papers latest_claims(const std::vector<NamedDigest>& campaigns);

/// A claim with another verdict; not judged where it is not there.
struct NewVerdict {
  ClaimKey key;
  Verdict then, now;
  Origin origin;
  std::string says;
};
std::vector<NewVerdict> new_verdicts(const Papers& then, const Papers& now);

VerdictCounts counts_of(const LatestClaims& paper, Origin origin);

/// The text of a key, empty without one.
std::string text_of(const nlohmann::ordered_json& object, const char* key);

}  // namespace physinv
