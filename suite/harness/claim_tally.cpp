#include "suite/harness/claim_tally.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "suite/harness/errors.h"
#include "suite/harness/judge.h"
#include "suite/results/verdict_words.h"

namespace physinv {

std::vector<std::string> expected_to_fail(
    const std::string& names,
    const Registry& registry,
    const std::vector<Section>& sections) {
  std::set<std::string> known;
  for (const auto& e : registry.experiments())
    for (const Claim& c : e->claims) known.insert(e->name + " " + c.id);
  for (const Overview& o : registry.overviews())
    for (const Claim& c : o.claims) known.insert(o.paper + " " + c.id);
  for (const Section& s : sections)
    for (const ClaimResult& c : s.claims)
      known.insert(s.experiment + " " + c.id);
  std::vector<std::string> expected;
  std::istringstream list(names);
  for (std::string name; std::getline(list >> std::ws, name, ',');) {
    name.erase(name.find_last_not_of(' ') + 1);
    if (!known.contains(name))
      throw UsageError(
          fmt::format("--expected: there is no claim '{}'; give experiment and "
                      "id as 'report' prints them, separated by commas",
                      name));
    expected.push_back(name);
  }
  return expected;
}

namespace {

/// Does it gate, and is there a verdict that counts?
bool is_judged(const ClaimResult& c) {
  return c.gates &&
         (c.verdict == Verdict::reproduced ||
          c.verdict == Verdict::not_reproduced || is_explained(c.verdict));
}

/// It says why it fails, and nothing that was measured speaks against that.
bool states_why(const ClaimResult& c) {
  return !c.cause.empty() && std::none_of(c.shown_by.begin(),
                                          c.shown_by.end(),
                                          [](const ConditionResult& r) {
                                            return !r.holds.value_or(true);
                                          });
}

/// Where one gating claim belongs; `name` is "experiment id".
void sort_in(const ClaimResult& c,
             const std::string& name,
             bool expected,
             ClaimTally& tally) {
  const bool holds = c.verdict == Verdict::reproduced;
  if (is_explained(c.verdict))
    tally.explained.push_back(
        fmt::format("{}: {}: {}", name, words_of(c.verdict), c.cause));
  else if (!holds && states_why(c))
    tally.known_misses.push_back(name + ": " + c.cause);
  else if (!holds)
    (expected ? tally.known_misses : tally.misses)
        .push_back(name + ": " + c.says);
  if (holds && expected) tally.surprises.push_back(name + ": " + c.says);
  if (holds && !c.cause.empty()) tally.stale.push_back(name + ": " + c.cause);
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

ClaimTally tally(const std::vector<Section>& sections,
                 const std::vector<std::string>& expected) {
  ClaimTally all;
  for (const Section& s : sections)
    for (const ClaimResult& c : s.claims) {
      if (!is_judged(c)) continue;
      ++all.judged;
      const std::string name = s.experiment + " " + c.id;
      sort_in(
          c,
          name,
          std::find(expected.begin(), expected.end(), name) != expected.end(),
          all);
    }
  return all;
}

}  // namespace physinv
