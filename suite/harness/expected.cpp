#include "suite/harness/expected.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "suite/harness/errors.h"
#include "suite/results/file.h"

namespace physinv {

std::vector<ExpectedFailure> read_expected(const std::filesystem::path& path) {
  std::vector<ExpectedFailure> all;
  try {
    const auto file = nlohmann::json::parse(read_file(path));
    for (const auto& entry : file.at("expected")) {
      all.push_back({.experiment = entry.at("experiment"),
                     .claim = entry.at("claim"),
                     .reason = entry.at("reason"),
                     .profile = entry.value("profile", "")});
      if (all.back().reason.empty())
        throw UsageError("an entry without a reason");
    }
  } catch (const std::exception& e) {
    throw UsageError(fmt::format(
        "{}: {}; entry {} is to have experiment, claim and a reason",
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
  std::map<std::string, std::set<std::string>> known;
  for (const auto& e : registry.experiments())
    for (const Claim& c : e->claims) known[e->name].insert(c.id);
  for (const Overview& o : registry.overviews())
    for (const Claim& c : o.claims) known[o.paper].insert(c.id);
  for (const Section& s : sections)
    for (const ClaimResult& c : s.claims) known[s.experiment].insert(c.id);
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
  }
}

ClaimTally compare(const std::vector<Section>& sections,
                   const std::vector<ExpectedFailure>& expected,
                   const std::string& profile) {
  ClaimTally judgement;
  for (const Section& s : sections) {
    for (const ClaimResult& c : s.claims) {
      const bool holds = c.verdict == Verdict::reproduced;
      if (!c.gates || (!holds && c.verdict != Verdict::not_reproduced))
        continue;
      ++judgement.judged;
      const auto listed = std::find_if(
          expected.begin(), expected.end(), [&](const ExpectedFailure& e) {
            return e.experiment == s.experiment && e.claim == c.id &&
                   (e.profile.empty() || e.profile == profile);
          });
      const bool known = listed != expected.end();
      const std::string name = s.experiment + " " + c.id + ": ";
      if (holds && known) judgement.surprises.push_back(name + c.says);
      if (!holds && !known) judgement.misses.push_back(name + c.says);
      if (!holds && known)
        judgement.known_misses.push_back(name + listed->reason);
    }
  }
  return judgement;
}

}  // namespace physinv
