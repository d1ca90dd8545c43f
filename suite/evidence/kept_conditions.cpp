// Conditions judged by what an earlier judgement kept.
#include <algorithm>
#include <string_view>
#include <utility>

#include "suite/evidence/condition.h"

namespace physinv {
namespace {

/// The word before the numbers: ">", "in", "printed", "about"; whatever a
/// number was compared with.
std::string_view relation_of(std::string_view bounds) {
  const auto word = bounds.substr(0, bounds.find(' '));
  return word == "as" || word == "about" ? "printed" : word;
}

bool has_runs(const Quantity& q) { return !q.runs().empty(); }

/// Was the number compared with one that was measured and is not kept?
bool has_measured_bound(const Condition& c) {
  return std::any_of(c.quantities.begin() + 1, c.quantities.end(), has_runs);
}

/// By the numbers under other labels that its own is made of.
std::optional<ConditionResult> by_parts(const Condition& condition,
                                        const Kept& kept,
                                        const Evidence& planned) {
  const auto find = [&](const std::string& label) -> std::optional<Measured> {
    for (const ConditionResult& c : kept)
      if (c.label == label)
        return Measured{c.value, c.spread, c.runs, c.missing};
    return {};
  };
  const auto number = condition.quantities.front().of_parts(planned, find);
  if (!number) return {};
  ConditionResult r = result_of(condition.label, condition.bounds, *number);
  if (condition.decide) condition.decide(planned, r);
  return r;
}

/// By a number that was kept under the label.
std::optional<ConditionResult> by_label(const Condition& condition,
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
    if (condition.decide && !has_measured_bound(condition))
      condition.decide(planned, r);
    if (only_reported && !r.holds) continue;
    return r;
  }
  return {};
}

ConditionResult of_one(const Condition& condition,
                       const Kept& kept,
                       const Remains& remains) {
  ConditionResult left{.label = condition.label,
                       .bounds = condition.bounds,
                       .missing = kNotKept};
  if (condition.of_stages) {
    left = condition.judge(remains.stages);
    if (left.value) return left;
  }
  if (const auto r = by_parts(condition, kept, remains.planned)) return *r;
  if (const auto r = by_label(condition, kept, remains.planned)) return *r;
  return left;
}

/// One that holds, else the first that something was kept of.
ConditionResult of_alternatives(const Condition& condition,
                                const Kept& kept,
                                const Remains& remains) {
  std::optional<ConditionResult> found;
  for (const Condition& one : condition.alternatives) {
    ConditionResult r = judge_kept(one, kept, remains);
    if (r.missing == kNotKept) continue;
    if (r.holds.value_or(false)) return r;
    if (!found) found = std::move(r);
  }
  return found ? *found : of_one(condition, kept, remains);
}

}  // namespace

ConditionResult judge_kept(const Condition& condition,
                           const Kept& kept,
                           const Remains& remains) {
  const auto& asks = condition.quantities;
  if (std::none_of(asks.begin(), asks.end(), has_runs))
    return condition.judge(remains.planned);
  ConditionResult r = condition.alternatives.empty()
                          ? of_one(condition, kept, remains)
                          : of_alternatives(condition, kept, remains);
  if (r.label == condition.label) r.shown = condition.shown;
  return r;
}

}  // namespace physinv
