// Conditions decided anew by what an earlier judgement kept.
#include <algorithm>
#include <string_view>
#include <utility>

#include "suite/evidence/condition.h"

namespace physinv {

const ConditionResult* find_kept(const Kept& kept, const std::string& label) {
  for (const ConditionResult& c : kept)
    if (c.label == label) return &c;
  return nullptr;
}

namespace {

/// The word before the numbers: ">", "in", "printed", "about"; whatever a
/// number was held against.
std::string_view relation_of(std::string_view bounds) {
  const auto word = bounds.substr(0, bounds.find(' '));
  return word == "as" || word == "about" ? "printed" : word;
}

/// Of alternatives one that holds, else the first that was decided.
std::optional<ConditionResult> decide_either(const Condition& condition,
                                             const Kept& kept,
                                             const Remains& remains) {
  std::optional<ConditionResult> found;
  for (const Condition& one : condition.alternatives) {
    ConditionResult r = decide_again(one, kept, remains);
    if (r.missing == kNotKept) continue;
    if (r.holds.value_or(false)) return r;
    if (!found) found = std::move(r);
  }
  return found;
}

/// A number that was kept under the label, decided by today's bound.
std::optional<ConditionResult> decide_kept(const Condition& condition,
                                           const Kept& kept,
                                           const Evidence& planned) {
  for (const ConditionResult& old : kept) {
    if (old.label != condition.label) continue;
    ConditionResult r = old;
    if (condition.bounds.empty()) r.bounds.clear(), r.holds.reset();
    const bool only_reported = r.bounds.empty() && !condition.bounds.empty();
    if (!only_reported &&
        relation_of(r.bounds) != relation_of(condition.bounds))
      continue;
    if (condition.again) condition.again(planned, kept, r);
    if (only_reported && !r.holds) continue;
    return r;
  }
  return {};
}

}  // namespace

namespace {

ConditionResult decide_by_label(const Condition& condition,
                                const Kept& kept,
                                const Remains& remains) {
  const Evidence& evidence = remains.planned;
  const auto& asks = condition.quantities;
  if (std::all_of(asks.begin(), asks.end(), [](const Quantity& q) {
        return q.runs().empty();
      }))
    return condition.judge(evidence);
  if (const auto r = decide_either(condition, kept, remains)) return *r;
  ConditionResult left;
  if (condition.of_stages) {
    left = condition.judge(remains.stages);
    if (left.value) return left;
  }
  if (const auto r = decide_kept(condition, kept, evidence)) return *r;
  if (condition.of_stages) return left;
  ConditionResult r{.label = condition.label, .bounds = condition.bounds};
  r.missing = kNotKept;
  const auto& parts = condition.parts;
  if (!parts.empty() &&
      std::all_of(parts.begin(), parts.end(), [&](const std::string& part) {
        return find_kept(kept, part) != nullptr;
      }))
    condition.again(evidence, kept, r);
  return r;
}

}  // namespace

ConditionResult decide_again(const Condition& condition,
                             const Kept& kept,
                             const Remains& remains) {
  ConditionResult r = decide_by_label(condition, kept, remains);
  if (r.label == condition.label) r.shown = condition.shown;
  return r;
}

}  // namespace physinv
