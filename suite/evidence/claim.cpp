#include "suite/evidence/claim.h"

#include <fmt/format.h>

#include <algorithm>

#include "suite/results/published.h"
#include "suite/results/results.h"
#include "suite/results/verdict_words.h"

namespace physinv {
namespace {

std::ptrdiff_t rank_of(const std::vector<std::string>& profiles,
                       const std::string& name) {
  return std::find(profiles.begin(), profiles.end(), name) - profiles.begin();
}

/// The largest profile that a campaign ran of the experiment, -1 for none. A
/// profile that is not declared ranks like the last one.
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
  if (!c.value) return fmt::format("{}: {}", c.text(), c.missing);
  std::string text = c.text() + " " + number_text(*c.value);
  if (c.spread) text += " ± " + number_text(*c.spread);
  if (c.bounds.empty()) return text;
  text += " (" + c.bounds;
  if (!c.holds) text += ": " + c.missing;
  if (c.holds && !*c.holds) text += ": no";
  return text + ")";
}

/// What the conditions alone say.
Verdict outcome(const std::vector<ConditionResult>& conditions) {
  bool missing = false, decided = false;
  for (const ConditionResult& c : conditions) {
    if (c.holds && !*c.holds) return Verdict::not_reproduced;
    decided = decided || c.holds;
    missing = missing || (!c.holds && !c.bounds.empty());
  }
  if (missing) return decided ? Verdict::partly_judged : Verdict::not_judged;
  if (decided) return Verdict::reproduced;
  const bool any =
      std::any_of(conditions.begin(), conditions.end(), [](const auto& c) {
        return c.value.has_value();
      });
  return any ? Verdict::reported : Verdict::not_judged;
}

bool explains_failure(const Cause& cause) {
  return cause.as == Verdict::not_reproduced || is_explained(cause.as);
}

/// What a number in the text of a cause is, of a claim whose conditions were
/// judged; `check` judges another condition.
template <class F>
ConditionResult measured(const Claim& claim,
                         const CauseNumber& number,
                         const ClaimResult& judged,
                         F&& check) {
  if (number.number) return check(*number.number);
  for (std::size_t k = 0; k < judged.conditions.size(); ++k)
    if (claim.conditions[k].label == number.label) return judged.conditions[k];
  for (const Condition& c : claim.cause.shown_by)
    if (c.label == number.label) return check(c);
  return {};
}

/// The verdict of what was measured, and the cause of it; `check` judges a
/// condition of the cause, or a number in its text.
template <class F>
void explain(const Claim& claim, F&& check, ClaimResult& out) {
  const Cause& cause = claim.cause;
  const bool fails = out.verdict == Verdict::not_reproduced;
  if (cause.why.empty() || (fails && !explains_failure(cause)) ||
      (out.verdict == Verdict::reproduced && !explains_failure(cause)))
    return;
  out.cause =
      with_numbers(cause.why, cause.numbers, [&](const CauseNumber& number) {
        return measured(claim, number, out, check);
      });
  if (!fails) return;
  out.verdict = cause.as;
  for (const Condition& c : cause.shown_by) {
    out.shown_by.push_back(check(c));
    const ConditionResult& r = out.shown_by.back();
    if (r.holds.value_or(true)) continue;
    out.verdict = Verdict::not_reproduced;
    out.cause +=
        fmt::format(" (which does not show here: {})", evidence_text(r));
  }
}

/// The claim without a verdict.
ClaimResult unjudged(const Claim& claim) {
  return {.id = claim.id,
          .says = claim.says,
          .from = claim.judged_from(),
          .gates = claim.gates,
          .verdict = Verdict::not_judged,
          .evidence = {},
          .origin = claim.origin(),
          .where = claim.where,
          .note = claim.note};
}

void add(ConditionResult result, ClaimResult& out) {
  out.evidence += (out.evidence.empty() ? "" : "; ") + evidence_text(result);
  out.conditions.push_back(std::move(result));
}

ClaimResult judge(const Claim& claim,
                  const Evidence& evidence,
                  std::ptrdiff_t rank,
                  const std::vector<std::string>& profiles) {
  ClaimResult out = unjudged(claim);
  if (rank < rank_of(profiles, claim.judged_from())) {
    out.evidence = fmt::format("needs the profile {}", claim.judged_from());
  } else {
    for (const Condition& c : claim.conditions) add(c.judge(evidence), out);
    out.verdict = outcome(out.conditions);
  }
  explain(
      claim, [&](const Condition& c) { return c.judge(evidence); }, out);
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

ClaimResult judge_again(const Claim& claim,
                        const ClaimResult& kept,
                        const Remains& remains) {
  ClaimResult out = unjudged(claim);
  if (kept.conditions.empty()) {
    out.evidence = kept.evidence;
  } else {
    // Labels may repeat: each number is taken once.
    Kept left = kept.conditions;
    for (const Condition& c : claim.conditions) {
      add(judge_kept(c, left, remains), out);
      const auto taken =
          std::find_if(left.begin(), left.end(), [&](const auto& old) {
            return old.label == out.conditions.back().label;
          });
      if (taken != left.end()) left.erase(taken);
    }
    out.verdict = outcome(out.conditions);
  }
  Kept all = kept.conditions;
  all.insert(all.end(), kept.shown_by.begin(), kept.shown_by.end());
  explain(
      claim,
      [&](const Condition& c) { return judge_kept(c, all, remains); },
      out);
  return out;
}

std::int64_t cases_behind(const Claim& claim,
                          const ClaimResult& judged,
                          const Evidence& evidence) {
  std::size_t cases = 0;
  const auto count =
      std::min(claim.conditions.size(), judged.conditions.size());
  for (std::size_t k = 0; k < count; ++k) {
    if (!judged.conditions[k].holds) continue;
    for (const Quantity& q : claim.conditions[k].quantities)
      for (const Select& s : q.runs()) cases += find_runs(evidence, s).size();
  }
  return static_cast<std::int64_t>(cases);
}

std::string conditions_text(const Claim& claim) {
  std::string text;
  for (const Condition& c : claim.conditions) {
    if (!text.empty()) text += "; ";
    text += c.bounds.empty() ? c.text() : c.text() + " " + c.bounds;
  }
  return text;
}

std::vector<Condition> all_conditions(const Claim& claim) {
  auto all = joined({claim.conditions, claim.cause.shown_by});
  for (const CauseNumber& n : claim.cause.numbers)
    if (n.number) all.push_back(*n.number);
  return all;
}

std::vector<std::string> errors_of(const Claim& claim,
                                   const std::vector<std::string>& profiles) {
  std::vector<std::string> wrong;
  const auto add = [&](const std::string& what) {
    wrong.push_back(fmt::format("claim {} {}", claim.id, what));
  };
  if (claim.id.empty()) add("has no id");
  if (claim.says.empty()) add("has no statement");
  if (claim.id.starts_with('P') && claim.where.empty())
    add("needs the place in the paper, because its id begins with P");
  if (claim.conditions.empty() && claim.note.empty() && claim.cause.why.empty())
    add("has no conditions and neither note nor cause why");
  if (claim.cause.as == Verdict::reproduced ||
      claim.cause.why.find('\n') != std::string::npos)
    add("has an invalid cause");
  if (claim.cause.as != Verdict::not_reproduced && claim.cause.why.empty())
    add("has a cause without a text");
  if (rank_of(profiles, claim.judged_from()) ==
      static_cast<std::ptrdiff_t>(profiles.size()))
    add(fmt::format("is judged from the unknown profile '{}'",
                    claim.judged_from()));
  return wrong;
}

std::vector<std::string> unknown_printed(const std::vector<Claim>& claims,
                                         const std::string& experiment,
                                         const Published& published) {
  std::vector<std::string> wrong;
  for (const Claim& claim : claims)
    for (const Condition& c : all_conditions(claim))
      for (const Quantity& q : c.quantities)
        for (const std::string& name : q.printed())
          if (!find_printed(published, experiment, name))
            wrong.push_back(
                fmt::format("{}: claim {} names the printed value {}, which "
                            "the paper's file lacks",
                            experiment,
                            claim.id,
                            name));
  return wrong;
}

}  // namespace physinv
