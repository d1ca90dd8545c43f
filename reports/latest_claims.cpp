#include "reports/latest_claims.h"

#include <algorithm>
#include <tuple>

#include "reports/report.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

int weight(Verdict verdict) {
  switch (verdict) {
    case Verdict::not_judged:
      return 0;
    case Verdict::reported:
      return 1;
    case Verdict::partly_judged:
      return 2;
    default:
      return 3;
  }
}

/// A verdict before none, and of two that of the more cases: a part that was
/// run again does not decide the whole.
auto rank_of(const LatestClaim& c) {
  return std::tuple(weight(c.claim.verdict), c.cases);
}

/// "P10b" -> ("P", 10 as text, the longer the later, "b").
auto parts_of(const std::string& id) {
  const auto digits = "0123456789";
  const auto first = std::min(id.find_first_of(digits), id.size());
  const auto last = std::min(id.find_first_not_of(digits, first), id.size());
  return std::tuple(id.substr(0, first),
                    last - first,
                    id.substr(first, last - first),
                    id.substr(last));
}

std::string date_of(const NamedDigest& campaign) {
  return text_of(campaign.digest.at("provenance"), "date");
}

}  // namespace

bool ByNumber::operator()(const ClaimKey& a, const ClaimKey& b) const {
  return a.first != b.first ? a.first < b.first
                            : parts_of(a.second) < parts_of(b.second);
}

std::string text_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return "";
  return found->is_string() ? found->get<std::string>() : found->dump();
}

std::vector<NamedDigest> newest_first(std::vector<NamedDigest> campaigns) {
  std::vector<std::pair<std::string, NamedDigest>> dated;
  for (NamedDigest& c : campaigns) dated.emplace_back(date_of(c), std::move(c));
  std::stable_sort(
      dated.begin(), dated.end(), [](const auto& a, const auto& b) {
        return a.first > b.first;
      });
  campaigns.clear();
  for (auto& [date, c] : dated) campaigns.push_back(std::move(c));
  return campaigns;
}

Papers latest_claims(const std::vector<NamedDigest>& campaigns) {
  Papers papers;
  for (const NamedDigest& c : newest_first(campaigns))
    for (const Json& section : c.digest.at("sections"))
      for (const Json& claim : section.at("claims")) {
        LatestClaim found{
            claim_from(claim), c.name, claim.value("cases", std::int64_t{0})};
        const auto [entry, first] =
            papers[section.at("paper").get<std::string>()].try_emplace(
                {section.at("experiment").get<std::string>(), found.claim.id},
                found);
        if (!first && rank_of(found) > rank_of(entry->second))
          entry->second = std::move(found);
      }
  return papers;
}

std::vector<NewVerdict> new_verdicts(const Papers& then, const Papers& now) {
  std::vector<NewVerdict> changed;
  for (const auto& [paper, claims] : then) {
    const auto own = now.find(paper);
    for (const auto& [key, before] : claims) {
      Verdict verdict = Verdict::not_judged;
      if (own != now.end())
        if (const auto at = own->second.find(key); at != own->second.end())
          verdict = at->second.claim.verdict;
      if (verdict != before.claim.verdict)
        changed.push_back({key,
                           before.claim.verdict,
                           verdict,
                           before.claim.origin,
                           before.claim.says});
    }
  }
  return changed;
}

VerdictCounts counts_of(const LatestClaims& paper, Origin origin) {
  VerdictCounts counts{};
  for (const auto& [id, s] : paper)
    if (s.claim.origin == origin)
      ++counts[static_cast<std::size_t>(s.claim.verdict)];
  return counts;
}

}  // namespace physinv
