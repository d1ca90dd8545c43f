#include "suite/gate/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "suite/gate/digits.h"

namespace physinv {
namespace {

/// How bad an end is; who failed and who was skipped have no result.
int rank(Stop stop) { return std::min(static_cast<int>(stop), 3); }

/// What speaks for and against a stage.
struct Findings {
  std::vector<std::string> worse, better, neutral;
};

void compare_ends(const StageLine& a, const StageLine& b, Findings& found) {
  if (a.stop != b.stop) {
    auto& side = rank(b.stop) > rank(a.stop) ? found.worse : found.better;
    side.push_back(fmt::format("{} -> {}{}{}",
                               to_string(a.stop),
                               to_string(b.stop),
                               b.message.empty() ? "" : ": ",
                               b.message));
  }
  constexpr auto kBad = static_cast<std::size_t>(Status::nonfinite);
  if (a.statuses != b.statuses) {
    auto& side =
        b.statuses[kBad] > a.statuses[kBad] ? found.worse : found.neutral;
    side.push_back(fmt::format(
        "{} -> {}", status_text(a.statuses), status_text(b.statuses)));
  }
  if (a.losses.nonfinite != b.losses.nonfinite) {
    auto& side =
        b.losses.nonfinite > a.losses.nonfinite ? found.worse : found.better;
    side.push_back(fmt::format("losses that are not finite {} -> {}",
                               a.losses.nonfinite,
                               b.losses.nonfinite));
  }
}

void compare_losses(const StageLine& a, const StageLine& b, Findings& found) {
  const auto compare = [&](const char* which, double before, double now) {
    const double moved = log_distance(before, now);
    if (!(std::abs(moved) > tolerance(a.digits))) return;
    (moved > 0 ? found.worse : found.better)
        .push_back(fmt::format("{} loss {:.{}e} -> {:.{}e} ({} stable digits)",
                               which,
                               before,
                               std::clamp(a.digits, 1, 12),
                               now,
                               std::clamp(a.digits, 1, 12),
                               a.digits));
  };
  compare("best", a.losses.best, b.losses.best);
  compare("median", a.losses.median, b.losses.median);
  compare("worst", a.losses.worst, b.losses.worst);
}

/// With the same bits promised, no more than before; otherwise what one ulp in
/// the data moved is left, twice.
void compare_work(const StageLine& a,
                  const StageLine& b,
                  Rules rules,
                  bool same,
                  Findings& found) {
  for (std::size_t i = 0; i < kWork.size(); ++i) {
    if (a.work[i] == b.work[i]) continue;
    const std::string text =
        fmt::format("{} {} -> {}", kWork[i], a.work[i], b.work[i]);
    const std::uint64_t slack = rules.bits ? 0 : 2 * a.play[i];
    const bool grown = b.work[i] > a.work[i] + slack;
    // Less work does not make up for bits that were promised.
    const bool less = b.work[i] + slack < a.work[i] && (same || !rules.bits);
    (grown && !rules.allow_work ? found.worse
     : less                     ? found.better
                                : found.neutral)
        .push_back(text);
  }
}

}  // namespace

std::string_view to_string(Change change) {
  constexpr std::string_view names[] = {
      "same", "within", "better", "worse", "missing", "new"};
  return names[static_cast<std::size_t>(change)];
}

StageVerdict judge(const StageLine& before, const StageLine& now, Rules rules) {
  Findings found;
  const bool same = same_bits(before, now);
  compare_ends(before, now, found);
  if (!same) compare_losses(before, now, found);
  compare_work(before, now, rules, same, found);

  StageVerdict j{.stage = now.name, .before = before, .now = now};
  if (!found.worse.empty()) {
    j.change = Change::worse;
  } else if (!found.better.empty()) {
    j.change = Change::better;
  } else if (!same && rules.bits) {
    j.change = Change::worse;
    j.reasons.emplace_back("other bits, and this build promises the same");
  } else if (!same) {
    j.change = Change::within;
  }
  for (auto* side : {&found.worse, &found.better, &found.neutral})
    j.reasons.insert(j.reasons.end(), side->begin(), side->end());
  return j;
}

std::vector<StageVerdict> judge(const std::vector<StageLine>& before,
                                const std::vector<StageLine>& now,
                                Rules rules) {
  std::map<std::string, const StageLine*> have;
  for (const auto& line : now) have[line.name] = &line;
  std::vector<StageVerdict> all;
  for (const auto& line : before) {
    const auto at = have.find(line.name);
    if (at == have.end()) {
      all.push_back({.stage = line.name,
                     .change = Change::missing,
                     .reasons = {"not run, or not registered any more"},
                     .before = line,
                     .now = {}});
      continue;
    }
    all.push_back(judge(line, *at->second, rules));
    have.erase(at);
  }
  for (const auto& line : now)
    if (have.contains(line.name))
      all.push_back({.stage = line.name,
                     .change = Change::added,
                     .reasons = {"the baseline does not hold it"},
                     .before = {},
                     .now = line});
  return all;
}

}  // namespace physinv
