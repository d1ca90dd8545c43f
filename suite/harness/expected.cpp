#include "suite/harness/expected.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "suite/harness/errors.h"
#include "suite/harness/judge.h"
#include "suite/results/verdict_words.h"
#include "suite/store/file.h"

namespace physinv {

std::vector<ExpectedFailure> read_expected(const std::filesystem::path& path) {
  std::vector<ExpectedFailure> all;
  try {
    const auto file = nlohmann::json::parse(read_file(path));
    for (const auto& entry : file.at("expected")) {
      all.push_back({.experiment = entry.at("experiment"),
                     .claim = entry.at("claim"),
                     .reason = entry.value("reason", ""),
                     .profile = entry.value("profile", "")});
      if (entry.contains("reason") && all.back().reason.empty())
        throw UsageError("an entry with an empty reason");
    }
  } catch (const std::exception& e) {
    throw UsageError(fmt::format(
        "{}: {}; entry {} is to have experiment, claim and a reason, or a "
        "claim that states its cause",
        path.string(),
        e.what(),
        all.size()));
  }
  return all;
}

std::vector<ExpectedFailure> known_to(const Registry& registry,
                                      std::vector<ExpectedFailure> expected) {
  std::erase_if(expected, [&](const ExpectedFailure& e) {
    const auto& overviews = registry.overviews();
    return !registry.find(e.experiment) &&
           std::none_of(
               overviews.begin(), overviews.end(), [&](const Overview& o) {
                 return o.paper == e.experiment;
               });
  });
  return expected;
}

void check_expected(const std::vector<ExpectedFailure>& expected,
                    const Registry& registry,
                    const std::vector<Section>& sections,
                    const std::filesystem::path& path) {
  // Experiment, claim: cause.
  std::map<std::string, std::map<std::string, std::string>> known;
  for (const auto& e : registry.experiments())
    for (const Claim& c : e->claims) known[e->name][c.id] = c.cause.why;
  for (const Overview& o : registry.overviews())
    for (const Claim& c : o.claims) known[o.paper][c.id] = c.cause.why;
  for (const Section& s : sections)
    for (const ClaimResult& c : s.claims)
      known[s.experiment].try_emplace(c.id, c.cause);
  for (const auto& e : expected) {
    const auto claims = known.find(e.experiment);
    const bool there = claims == known.end()
                           ? registry.find(e.experiment) != nullptr
                           : claims->second.contains(e.claim);
    if (!there)
      throw UsageError(fmt::format(
          "{}: there is no claim {} of {}; take the entry out or name one that "
          "'report' shows",
          path.string(),
          e.claim,
          e.experiment));
    if (e.reason.empty() && claims != known.end() &&
        claims->second.at(e.claim).empty())
      throw UsageError(
          fmt::format("{}: {} {} has no reason, and its claim no cause; give "
                      "one of them",
                      path.string(),
                      e.experiment,
                      e.claim));
  }
}

namespace {

/// Does it gate, and is there a verdict that counts?
bool is_judged(const ClaimResult& c) {
  return c.gates &&
         (c.verdict == Verdict::reproduced ||
          c.verdict == Verdict::not_reproduced || is_explained(c.verdict));
}

/// Where one gating claim of an experiment belongs.
void sort_in(const ClaimResult& c,
             const std::string& name,
             const ExpectedFailure* listed,
             ClaimTally& tally) {
  const bool holds = c.verdict == Verdict::reproduced;
  if (is_explained(c.verdict))
    tally.explained.push_back(
        fmt::format("{}{}: {}", name, words_of(c.verdict, c.origin), c.cause));
  else if (!holds && listed == nullptr)
    tally.misses.push_back(name + c.says);
  else if (!holds)
    tally.known_misses.push_back(
        name + (listed->reason.empty() ? c.cause : listed->reason));
  if (holds && listed != nullptr) tally.surprises.push_back(name + c.says);
  if (holds && !c.cause.empty()) tally.stale.push_back(name + c.cause);
}

}  // namespace

std::size_t decided_by_runs(const Registry& registry,
                            const std::vector<Section>& sections,
                            const Results& results,
                            const Published& published) {
  std::size_t decided = 0;
  for (const Section& s : sections) {
    const std::vector<Claim> claims = claims_of(registry, s.experiment);
    for (const ClaimResult& c : s.claims) {
      if (!is_judged(c)) continue;
      const auto own =
          std::find_if(claims.begin(), claims.end(), [&](const Claim& claim) {
            return claim.id == c.id;
          });
      decided += own == claims.end() ||
                 cases_behind(*own, c, {results, published, s.experiment}) > 0;
    }
  }
  return decided;
}

ClaimTally compare(const std::vector<Section>& sections,
                   const std::vector<ExpectedFailure>& expected,
                   const std::string& profile) {
  ClaimTally judgement;
  for (const Section& s : sections) {
    for (const ClaimResult& c : s.claims) {
      if (!is_judged(c)) continue;
      ++judgement.judged;
      const auto listed = std::find_if(
          expected.begin(), expected.end(), [&](const ExpectedFailure& e) {
            return e.experiment == s.experiment && e.claim == c.id &&
                   (e.profile.empty() || e.profile == profile);
          });
      sort_in(c,
              s.experiment + " " + c.id + ": ",
              listed == expected.end() ? nullptr : &*listed,
              judgement);
    }
  }
  return judgement;
}

}  // namespace physinv
