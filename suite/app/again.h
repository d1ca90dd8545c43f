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

/// Those of `campaigns` below `folder` that decide a claim (`latest` is what
/// all of them come to) of this paper, with the paper's cases alone, or,
/// without a paper, all of them; the cheapest first.
std::vector<Again> to_run_again(const std::vector<NamedDigest>& campaigns,
                                const Papers& latest,
                                const std::filesystem::path& folder,
                                const std::string& paper);

}  // namespace physinv
