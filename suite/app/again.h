/// Published campaigns as they are run again.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "reports/latest_claims.h"

namespace physinv {

struct Again {
  std::string name;
  /// Names of cases by the profile that they were run for.
  std::map<std::string, std::vector<std::string>> cases;
  std::vector<std::string> sets;  ///< --set of the campaign
  std::string seeds;              ///< of all cases: "0,1,2"
  double cpu_seconds = 0;         ///< of solving, when it was published
  std::size_t unknown = 0;        ///< cases that are not registered now
  std::vector<ClaimKey> decides;  ///< what it decides of all campaigns

  std::size_t size() const;  ///< cases
};

/// "jpo/billiards P1"
std::string name_of(const ClaimKey& claim);

/// Of `campaigns` below `folder`, those of these names or, without names, all
/// that decide a claim of the paper, with the paper's cases alone; the
/// cheapest first. `latest` is what all of them come to.
std::vector<Again> to_run_again(const std::vector<NamedDigest>& campaigns,
                                const Papers& latest,
                                const std::filesystem::path& folder,
                                const std::vector<std::string>& names,
                                const std::string& paper);

}  // namespace physinv
