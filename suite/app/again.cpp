#include "suite/app/again.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <utility>

#include "suite/app/options.h"
#include "suite/app/published_campaign.h"
#include "suite/harness/registry.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string paper_of(const std::string& experiment) {
  const auto e = registry().find(experiment);
  return e ? e->citation.paper : "";
}

/// Leaves out cases that no profile has by now.
void drop_unknown(Again& again) {
  for (auto& [profile, names] : again.cases) {
    std::set<std::string> known;
    for (const Case& c :
         registry().expand(profile, parse_overrides(again.sets, again.seeds)))
      known.insert(c.info.name);
    again.unknown += std::erase_if(
        names, [&](const std::string& name) { return !known.contains(name); });
  }
  std::erase_if(again.cases, [](const auto& of) { return of.second.empty(); });
}

/// What results.json.gz of the campaign says was run, of one paper or of all.
Again again_of(const NamedDigest& campaign,
               const fs::path& folder,
               const std::string& paper) {
  const auto& provenance = campaign.digest.at("provenance");
  Again again{.name = campaign.name, .cases = {}, .sets = {}, .seeds = {}};
  if (const auto options = provenance.find("options");
      options != provenance.end())
    for (const auto& value : options->value("set", Json::array()))
      if (!value.get<std::string>().starts_with("seeds="))
        again.sets.push_back(value);
  std::set<std::uint64_t> seeds;
  const Results results = published_results(folder);
  for (const CaseRecord& c : results.cases()) {
    if (!paper.empty() && paper_of(c.info.experiment) != paper) continue;
    const std::string& own = c.info.profile;
    again.cases[own.empty() ? provenance.value("profile", "") : own].push_back(
        c.info.name);
    seeds.insert(c.info.seed);
    for (const StageRecord& s : c.stages)
      if (has_time(s)) again.cpu_seconds += s.clocks.solve.cpu;
  }
  again.seeds = fmt::format("{}", fmt::join(seeds, ","));
  drop_unknown(again);
  return again;
}

}  // namespace

std::size_t Again::size() const {
  std::size_t all = 0;
  for (const auto& [profile, names] : cases) all += names.size();
  return all;
}

std::vector<Again> to_run_again(const std::vector<NamedDigest>& campaigns,
                                const Papers& latest,
                                const fs::path& folder,
                                const std::string& paper) {
  std::map<std::string, std::vector<ClaimKey>> decides;
  for (const auto& [key, claims] : latest)
    if (paper.empty() || key == paper)
      for (const auto& [claim, found] : claims)
        if (found.claim.verdict != Verdict::not_judged)
          decides[found.campaign].push_back(claim);
  std::vector<Again> all;
  for (const NamedDigest& c : campaigns) {
    if (!paper.empty() && !decides.contains(c.name)) continue;
    Again again = again_of(c, folder / c.name, paper);
    again.decides = decides[c.name];
    all.push_back(std::move(again));
  }
  std::stable_sort(all.begin(), all.end(), [](const Again& a, const Again& b) {
    return a.cpu_seconds < b.cpu_seconds;
  });
  return all;
}

}  // namespace physinv
