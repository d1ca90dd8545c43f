#include "suite/gate/verdict.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "suite/gate/digits.h"
#include "suite/results/ends.h"

namespace physinv {
namespace {

std::vector<std::string>& reasons_of(Reasons& reasons, Direction direction) {
  return direction == Direction::worse    ? reasons.worse
         : direction == Direction::better ? reasons.better
                                          : reasons.other;
}

/// Rounding decides how many examples meet a tolerance: it speaks against a
/// stage only where the same bits are promised, and never for it.
Direction direction_of_examples(const StageLine& a,
                                const StageLine& b,
                                Rules rules) {
  constexpr auto kBad = static_cast<std::size_t>(Status::nonfinite);
  const Direction found = direction(a.statuses, b.statuses);
  const bool counts = rules.bits || a.statuses[kBad] != b.statuses[kBad];
  return found == Direction::worse && counts ? found : Direction::other;
}

void compare_ends(const StageLine& a,
                  const StageLine& b,
                  Rules rules,
                  Reasons& found) {
  if (a.stop != b.stop)
    reasons_of(found, direction(a.stop, b.stop))
        .push_back(fmt::format("{} -> {}{}{}",
                               to_string(a.stop),
                               to_string(b.stop),
                               b.message.empty() ? "" : ": ",
                               b.message));
  if (a.statuses != b.statuses)
    reasons_of(found, direction_of_examples(a, b, rules))
        .push_back(fmt::format(
            "{} -> {}", status_text(a.statuses), status_text(b.statuses)));
  if (a.losses.nonfinite != b.losses.nonfinite)
    (b.losses.nonfinite > a.losses.nonfinite ? found.worse : found.better)
        .push_back(fmt::format("losses that are not finite {} -> {}",
                               a.losses.nonfinite,
                               b.losses.nonfinite));
}

/// They are of the finite ones: where one more or less is, the others' median
/// and the worst of them say nothing.
void compare_losses(const StageLine& a, const StageLine& b, Reasons& found) {
  const bool same_examples = a.losses.nonfinite == b.losses.nonfinite;
  const auto compare =
      [&](const char* which, double before, double now, bool counts) {
        const double moved = log_distance(before, now);
        if (!(std::abs(moved) > tolerance(a.digits))) return;
        const int shown = std::clamp(a.digits, 1, 12);
        reasons_of(found,
                   !counts     ? Direction::other
                   : moved > 0 ? Direction::worse
                               : Direction::better)
            .push_back(fmt::format("{} loss {:.{}e} -> {:.{}e} ({} stable "
                                   "digits)",
                                   which,
                                   before,
                                   shown,
                                   now,
                                   shown,
                                   a.digits));
      };
  compare("best", a.losses.best, b.losses.best, true);
  compare("median", a.losses.median, b.losses.median, same_examples);
  compare("worst", a.losses.worst, b.losses.worst, same_examples);
}

/// Do the costs of both compare? A stage that ended worse spent less.
bool costs_compare(const StageLine& a, const StageLine& b) {
  return a.losses.nonfinite == b.losses.nonfinite &&
         (a.stop == b.stop || (completes(a.stop) && completes(b.stop)));
}

/// With the same bits promised, no more than before; otherwise what one ulp in
/// the data moved is left, twice.
void compare_work(const StageLine& a,
                  const StageLine& b,
                  Rules rules,
                  bool same,
                  Reasons& found) {
  for (std::size_t i = 0; i < kWork.size(); ++i) {
    if (a.work[i] == b.work[i]) continue;
    const std::string text =
        fmt::format("{} {} -> {}", kWork[i], a.work[i], b.work[i]);
    const std::uint64_t slack = rules.bits ? 0 : 2 * a.jitter[i];
    const bool grown = b.work[i] > a.work[i] + slack;
    // Less work does not make up for bits that were promised.
    const bool less = b.work[i] + slack < a.work[i] && (same || !rules.bits);
    (!costs_compare(a, b)         ? found.other
     : grown && !rules.allow_work ? found.worse
     : less                       ? found.better
                                  : found.other)
        .push_back(text);
  }
}

/// 0 if the baseline's digits do not tell them apart.
double loss_change(double before, double now, int shown) {
  if (!std::isfinite(before) || !std::isfinite(now) ||
      fmt::format("{:.{}e}", before, shown) ==
          fmt::format("{:.{}e}", now, shown))
    return 0;
  return std::abs(now - before) / std::max(std::abs(now), std::abs(before));
}

std::optional<double> estimate_change(const StageLine& before,
                                      const StageLine& now) {
  if (!before.x || !now.x) return {};
  if (*before.x == *now.x) return 0;
  return std::abs(*now.x - *before.x) /
         std::max(now.x_norm, std::abs(*before.x));
}

Distance distance(const StageLine& before, const StageLine& now) {
  Distance d{.x = estimate_change(before, now)};
  const auto compared = [&](std::string_view which, double a, double b) {
    const double change = loss_change(a, b, shown_digits(before));
    if (change > d.loss) d.loss = change, d.which = which;
  };
  compared("best", before.losses.best, now.losses.best);
  compared("median", before.losses.median, now.losses.median);
  compared("worst", before.losses.worst, now.losses.worst);
  return d;
}

}  // namespace

std::string_view to_string(Change change) {
  constexpr std::string_view names[] = {
      "same", "within", "better", "worse", "missing", "new"};
  return names[static_cast<std::size_t>(change)];
}

std::string Reasons::text() const {
  std::string text;
  const bool several = (worse.empty() ? 0 : 1) + (better.empty() ? 0 : 1) +
                           (other.empty() ? 0 : 1) >
                       1;
  for (const auto& [word, all] : {std::pair("worse", &worse),
                                  std::pair("better", &better),
                                  std::pair("other", &other)}) {
    if (all->empty()) continue;
    text += fmt::format("{}{}{}{}",
                        text.empty() ? "" : "; ",
                        several ? word : "",
                        several ? ": " : "",
                        fmt::join(*all, "; "));
  }
  return text;
}

StageVerdict judge(const StageLine& before, const StageLine& now, Rules rules) {
  StageVerdict j{.stage = now.name, .before = before, .now = now};
  Reasons& found = j.reasons;
  const bool same = same_bits(before, now);
  compare_ends(before, now, rules, found);
  if (!same) compare_losses(before, now, found);
  compare_work(before, now, rules, same, found);

  if (!same) j.distance = distance(before, now);

  if (!found.worse.empty()) {
    j.change = Change::worse;
  } else if (!found.better.empty()) {
    j.change = Change::better;
  } else if (!same && rules.bits) {
    j.change = Change::worse;
    found.worse.emplace_back(
        "other bits, although this build must reproduce them");
  } else if (!same) {
    j.change = Change::within;
  }
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
                     .reasons = {.worse = {"not run, or no longer registered"}},
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
                     .reasons = {.other = {"not in the baseline"}},
                     .before = {},
                     .now = line});
  return all;
}

}  // namespace physinv
