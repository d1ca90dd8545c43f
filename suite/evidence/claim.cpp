#include "suite/evidence/claim.h"

#include <fmt/format.h>

#include <algorithm>

#include "suite/results/published.h"
#include "suite/results/results.h"

namespace physinv {
namespace {

std::ptrdiff_t rank_of(const std::vector<std::string>& profiles,
                       const std::string& name) {
  return std::find(profiles.begin(), profiles.end(), name) - profiles.begin();
}

/// The largest profile that a campaign ran of the experiment, -1 for none. A
/// profile that nobody declares is as good as the last: its user knows.
std::ptrdiff_t rank_of(const Evidence& evidence,
                       const std::vector<std::string>& profiles) {
  std::ptrdiff_t rank = -1;
  for (const CaseRecord& c : evidence.results.cases())
    if (c.info.experiment == evidence.experiment ||
        c.info.experiment.starts_with(evidence.experiment + "/"))
      rank = std::max(rank, rank_of(profiles, c.info.profile));
  return rank;
}

std::string evidence_text(const ConditionResult& c) {
  if (!c.value) return fmt::format("{}: {}", c.label, c.missing);
  std::string text = c.label + " " + number_text(*c.value);
  if (c.spread) text += " ± " + number_text(*c.spread);
  if (c.bounds.empty()) return text;
  text += " (" + c.bounds;
  if (!c.holds) text += ": " + c.missing;
  if (c.holds && !*c.holds) text += ": no";
  return text + ")";
}

Verdict verdict_of(const std::vector<ConditionResult>& conditions) {
  bool missing = false, decided = false;
  for (const ConditionResult& c : conditions) {
    if (c.holds && !*c.holds) return Verdict::not_reproduced;
    decided = decided || c.holds;
    missing = missing || (!c.holds && !c.bounds.empty());
  }
  if (missing) return Verdict::not_judged;
  if (decided) return Verdict::reproduced;
  const bool any =
      std::any_of(conditions.begin(), conditions.end(), [](const auto& c) {
        return c.value.has_value();
      });
  return any ? Verdict::reported : Verdict::not_judged;
}

ClaimResult judge(const Claim& claim,
                  const Evidence& evidence,
                  std::ptrdiff_t rank,
                  const std::vector<std::string>& profiles) {
  ClaimResult out{.id = claim.id,
                  .says = claim.says,
                  .from = claim.from,
                  .gates = claim.gates,
                  .verdict = Verdict::not_judged,
                  .evidence = {},
                  .origin = claim.origin,
                  .where = claim.where,
                  .note = claim.note,
                  .conditions = {}};
  if (rank < rank_of(profiles, claim.from)) {
    out.evidence = fmt::format("needs the profile {}", claim.from);
    return out;
  }
  for (const Condition& c : claim.conditions) {
    out.conditions.push_back(c.judge(evidence));
    out.evidence += (out.evidence.empty() ? "" : "; ") +
                    evidence_text(out.conditions.back());
  }
  out.verdict = verdict_of(out.conditions);
  return out;
}

}  // namespace

std::vector<ClaimResult> judge(const std::vector<Claim>& claims,
                               const Evidence& evidence,
                               const std::vector<std::string>& profiles) {
  const auto rank = rank_of(evidence, profiles);
  std::vector<ClaimResult> out;
  for (const Claim& claim : claims)
    out.push_back(judge(claim, evidence, rank, profiles));
  return out;
}

std::string conditions_text(const Claim& claim) {
  std::string text;
  for (const Condition& c : claim.conditions) {
    if (!text.empty()) text += "; ";
    text += c.bounds.empty() ? c.label : c.label + " " + c.bounds;
  }
  return text;
}

std::vector<std::string> problems_of(const Claim& claim,
                                     const std::vector<std::string>& profiles) {
  std::vector<std::string> wrong;
  const auto add = [&](const std::string& what) {
    wrong.push_back(fmt::format("claim {} {}", claim.id, what));
  };
  if (claim.id.empty()) add("has no id");
  if (claim.says.empty()) add("says nothing");
  if (claim.origin == Origin::paper && claim.where.empty())
    add("is the paper's and does not say where");
  if (claim.conditions.empty() && claim.note.empty())
    add("has no conditions and no note why");
  if (rank_of(profiles, claim.from) ==
      static_cast<std::ptrdiff_t>(profiles.size()))
    add(fmt::format("is judged from the unknown profile '{}'", claim.from));
  return wrong;
}

std::vector<std::string> unknown_printed(const std::vector<Claim>& claims,
                                         const std::string& experiment,
                                         const Published& published) {
  std::vector<std::string> wrong;
  for (const Claim& claim : claims)
    for (const Condition& c : claim.conditions)
      for (const Quantity& q : c.quantities)
        for (const std::string& name : q.printed())
          if (!published.find(experiment, name))
            wrong.push_back(
                fmt::format("{}: claim {} names the printed value {}, which "
                            "the paper's file lacks",
                            experiment,
                            claim.id,
                            name));
  return wrong;
}

}  // namespace physinv
