#include "suite/compare/regressions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace physinv {
namespace {

constexpr std::array<std::pair<std::string_view, Aspect>, 6> kWords = {
    {{"loss", Aspect::loss},
     {"status", Aspect::status},
     {"claims", Aspect::claims},
     {"work", Aspect::work},
     {"time", Aspect::time},
     {"missing", Aspect::missing}}};

/// A pair that got worse, and by how much.
struct Worse {
  double size = 0;
  std::string text;
  bool of_time = false;
};

std::string ratio_text(double ratio) {
  return std::isfinite(ratio) ? fmt::format("×{:.3g}", ratio)
                              : "no longer finite";
}

/// With `visit(stage, side)` of every stage on every side but the first.
template <class F>
void for_pairs(const Comparison& c, F&& visit) {
  for (const Compared& line : c.rows)
    for (const Compared& stage : line.stages())
      for (std::size_t s = 1; s < stage.sides.size(); ++s) visit(stage, s);
}

std::optional<Worse> worse_loss(const Reading& a,
                                const Reading& b,
                                double factor) {
  const double ratio = loss_ratio(a, b);
  if (!(ratio > factor)) return {};
  return Worse{ratio, ratio_text(ratio)};
}

std::optional<Worse> worse_end(const Reading& a, const Reading& b) {
  if (end_direction(a, b) != Direction::worse) return {};
  return Worse{static_cast<double>(b.ends.begin()->first), end_text(a, b)};
}

/// A stage that ends worse has no cost, which is not better.
std::optional<Worse> lost_cost(const Reading& a, const Reading& b) {
  return costs_compare(a, b) ? std::nullopt : worse_end(a, b);
}

std::optional<Worse> more_work(const Reading& a, const Reading& b) {
  if (!costs_compare(a, b)) return lost_cost(a, b);
  for (const auto& [work, word] :
       {std::pair(&Reading::simulations, "simulations"),
        std::pair(&Reading::passes, "passes")})
    if ((b.*work)() > (a.*work)())
      return Worse{(b.*work)() / std::max(1.0, (a.*work)()),
                   fmt::format("{} {} -> {}", word, (a.*work)(), (b.*work)())};
  return {};
}

std::optional<Worse> more_time(const Reading& a,
                               const Reading& b,
                               double factor) {
  if (!costs_compare(a, b)) return lost_cost(a, b);
  const TimeRatio ratio = time_ratio(a, b);
  if (ratio.b_unknown && !ratio.a_unknown)
    return Worse{INFINITY, "it has no time any more", true};
  if (!is_slower(ratio, factor)) return {};
  const double size = ratio.value.value_or(INFINITY);
  return Worse{
      size,
      fmt::format(
          "{:.3g} -> {:.3g} ms", 1e3 * ratio.a.median, 1e3 * ratio.b.median),
      true};
}

std::optional<Worse> worse_in(Aspect aspect,
                              const Reading& a,
                              const Reading& b,
                              double factor) {
  return aspect == Aspect::loss     ? worse_loss(a, b, factor)
         : aspect == Aspect::status ? worse_end(a, b)
         : aspect == Aspect::work   ? more_work(a, b)
                                    : more_time(a, b, factor);
}

std::optional<Regression> worse_pairs(Aspect aspect,
                                      const Comparison& c,
                                      double factor) {
  Regression found{.of_time = true};
  double most = -1;
  for_pairs(c, [&](const Compared& stage, std::size_t side) {
    const auto& a = stage.sides.front();
    const auto& b = stage.sides[side];
    if (!a || !b) return;
    ++found.judged;
    const auto worse = worse_in(aspect, *a, *b, factor);
    if (!worse) return;
    ++found.worse;
    found.of_time = found.of_time && worse->of_time;
    // Of a worse end before all that is slower.
    const double size = worse->size + (worse->of_time ? 0 : 1e300);
    if (size <= most) return;
    most = size;
    found.worst = fmt::format("{}: {}", stage.id.text(), worse->text);
  });
  return found.worse == 0 ? std::nullopt : std::optional(found);
}

std::optional<Regression> missing_pairs(const Comparison& c) {
  Regression found;
  for_pairs(c, [&](const Compared& stage, std::size_t side) {
    ++found.judged;
    if (stage.sides.front() && stage.sides[side]) return;
    if (++found.worse == 1)
      found.worst = fmt::format("{} is not in {}",
                                stage.id.text(),
                                c.labels[stage.sides.front() ? side : 0]);
  });
  return found.worse == 0 ? std::nullopt : std::optional(found);
}

std::optional<Regression> worse_claims(
    const std::vector<ChangedClaim>& changed) {
  Regression found{.judged = changed.size()};
  for (const ChangedClaim& claim : changed) {
    for (std::size_t s = 1; s < claim.sides.size(); ++s) {
      if (direction(claim.verdict(0), claim.verdict(s)) != Direction::worse)
        continue;
      if (++found.worse == 1) found.worst = claim.experiment + " " + claim.id();
      break;
    }
  }
  return found.worse == 0 ? std::nullopt : std::optional(found);
}

struct TimedPairs {
  std::size_t all = 0, compared = 0, unknown = 0;
  std::map<std::string, std::size_t> without;  ///< by reason
};

TimedPairs timed_pairs(const Comparison& c) {
  TimedPairs sum;
  for_pairs(c, [&](const Compared& stage, std::size_t side) {
    if (!stage.sides.front() || !stage.sides[side]) return;
    const auto ratio = time_ratio(*stage.sides.front(), *stage.sides[side]);
    ++sum.all;
    sum.compared += ratio.compares;
    if (!ratio.compares) ++sum.without[ratio.why];
    sum.unknown += !ratio.compares &&
                   costs_compare(*stage.sides.front(), *stage.sides[side]);
  });
  return sum;
}

std::string reasons_text(const std::map<std::string, std::size_t>& counts) {
  std::string text;
  for (const auto& [why, count] : counts)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, why);
  return text;
}

}  // namespace

std::optional<Aspect> aspect_of(std::string_view word) {
  for (const auto& [name, aspect] : kWords)
    if (name == word) return aspect;
  return {};
}

std::string Regression::text() const {
  return judged == 0 ? worst
                     : fmt::format("{} of {}, worst {}", worse, judged, worst);
}

std::optional<Regression> regression(Aspect aspect,
                                     const Comparison& c,
                                     const std::vector<ChangedClaim>& claims,
                                     double factor) {
  if (aspect == Aspect::claims) return worse_claims(claims);
  if (aspect == Aspect::missing) return missing_pairs(c);
  auto found = worse_pairs(aspect, c, factor);
  if (aspect != Aspect::time || found) return found;
  // Nothing passes because no time is known; stages that had none before they
  // ended well have none to compare with.
  const TimedPairs timed = timed_pairs(c);
  if (timed.compared > 0 || timed.unknown == 0) return {};
  return Regression{.worst = fmt::format("it has no times to compare with: {}",
                                         reasons_text(timed.without)),
                    .of_time = true};
}

std::string pairs_text(const Comparison& c) {
  std::size_t worse = 0, better = 0;
  for_pairs(c, [&](const Compared& stage, std::size_t side) {
    if (!stage.sides.front() || !stage.sides[side]) return;
    const auto end = end_direction(*stage.sides.front(), *stage.sides[side]);
    worse += end == Direction::worse;
    better += end == Direction::better;
  });
  const TimedPairs timed = timed_pairs(c);
  return fmt::format(
      "{} pairs: ends of {} worse, of {} better; times of {} compare{}",
      timed.all,
      worse,
      better,
      timed.compared,
      timed.without.empty()
          ? ""
          : "; of the others: " + reasons_text(timed.without));
}

}  // namespace physinv
