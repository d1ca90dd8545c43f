/// What published campaigns come to about each claim.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "reports/digest.h"
#include "suite/results/verdict_words.h"

namespace physinv {

struct Standing {
  ClaimResult claim;
  std::string campaign;
};
/// Experiment and id; ids by their number, P2 before P10.
using ClaimKey = std::pair<std::string, std::string>;
struct ByNumber {
  bool operator()(const ClaimKey& a, const ClaimKey& b) const;
};
using Standings = std::map<ClaimKey, Standing, ByNumber>;
/// By the key of the paper.
using Papers = std::map<std::string, Standings>;

/// By their dates, the newest first; as they are where dates are equal.
std::vector<NamedDigest> newest_first(std::vector<NamedDigest> campaigns);

/// The newest campaign that decided a claim counts, whatever it is called. What
/// was decided counts before what was judged in part, and that before what was
/// only reported.
Papers standings(const std::vector<NamedDigest>& campaigns);

VerdictCounts counts_of(const Standings& paper, Origin origin);

/// The text of a key, empty without one.
std::string text_of(const nlohmann::ordered_json& object, const char* key);

}  // namespace physinv
