#include "suite/results/ends.h"

#include <fmt/format.h>

#include <algorithm>

namespace physinv {
namespace {

constexpr std::size_t at(Status s) { return static_cast<std::size_t>(s); }

/// A larger number is worse.
template <class T>
Direction by(T from, T to) {
  return from == to  ? Direction::same
         : to > from ? Direction::worse
                     : Direction::better;
}

}  // namespace

std::string_view to_string(Direction direction) {
  constexpr std::string_view names[] = {"same", "better", "worse", "other"};
  return names[static_cast<std::size_t>(direction)];
}

Direction direction(Stop from, Stop to) {
  if (from == to) return Direction::same;
  const auto badness = [](Stop s) {
    return std::min(static_cast<int>(s), static_cast<int>(Stop::failed));
  };
  const Direction found = by(badness(from), badness(to));
  return found == Direction::same ? Direction::other : found;
}

StatusCounts count(const std::vector<Status>& statuses) {
  StatusCounts counts{};
  for (const Status s : statuses) ++counts[at(s)];
  return counts;
}

std::string status_text(const StatusCounts& counts,
                        std::string_view between,
                        char mark) {
  std::string text;
  for (const Status s : kStatuses)
    if (counts[at(s)] > 0)
      text += fmt::format("{}{}{}{}",
                          text.empty() ? "" : between,
                          to_string(s),
                          mark,
                          counts[at(s)]);
  return text;
}

Direction direction(const StatusCounts& from, const StatusCounts& to) {
  if (from == to) return Direction::same;
  constexpr auto kBad = at(Status::nonfinite);
  if (from[kBad] != to[kBad]) return by(from[kBad], to[kBad]);
  const auto misses = [](const StatusCounts& counts) {
    return -counts[at(Status::gtol)] - counts[at(Status::ftol)];
  };
  const Direction found = by(misses(from), misses(to));
  return found == Direction::same ? Direction::other : found;
}

Direction direction(Verdict from, Verdict to) {
  if (from == to) return Direction::same;
  constexpr int kExplained = 3, kFailed = 4;
  const auto badness = [](Verdict v) {
    return v == Verdict::reproduced       ? 0
           : v == Verdict::partly_judged  ? 1
           : v == Verdict::not_judged     ? 2
           : v == Verdict::not_reproduced ? kFailed
                                          : kExplained;
  };
  const bool no_more = badness(from) >= kExplained && badness(to) < kExplained;
  if (from == Verdict::reported || to == Verdict::reported ||
      (no_more && to != Verdict::reproduced))
    return Direction::other;
  const Direction found = by(badness(from), badness(to));
  return found == Direction::same ? Direction::other : found;
}

}  // namespace physinv
