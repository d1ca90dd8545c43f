#include "suite/evidence/standings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "suite/evidence/performance_profiles.h"
#include "suite/evidence/statistics.h"

namespace physinv {
namespace {

/// What counts for how a method ends on a problem: the hardest target tau that
/// its final loss reaches; 1 where it reaches none, 2 where it lies above the
/// start, infinite without a finite loss.
double level_of(double loss, const LossRange& range) {
  if (!std::isfinite(loss)) return loss;
  const double lowest = std::max(range.lowest, kEqualLoss);
  const double start = std::max(range.start, lowest);
  static const auto targets = distribution_targets();
  if (loss > start) return 2;
  double level = 1;
  for (const double tau : targets)
    if (loss <= lowest + tau * (start - lowest)) level = tau;
  return level;
}

/// Of each method, a level per problem.
std::vector<std::vector<double>> final_levels(const CommonRuns& common) {
  std::vector<std::vector<double>> all(common.methods.size());
  for (const CommonRun& group : common.groups)
    for (Index i = 0; i < group.examples; ++i) {
      const auto range = loss_range(group, i);
      for (std::size_t m = 0; m < all.size(); ++m) {
        const double loss = final_loss(group.histories[m], i);
        all[m].push_back(range ? level_of(loss, *range) : loss);
      }
    }
  return all;
}

void add_ranks(Standings& out, const std::vector<std::vector<double>>& losses) {
  const auto problems = static_cast<double>(out.problems);
  out.mean_rank.resize(losses.size());
  out.lowest.resize(losses.size());
  for (std::size_t p = 0; p < out.problems; ++p)
    for (std::size_t m = 0; m < losses.size(); ++m) {
      double below = 0, equal = 0;
      for (const auto& other : losses) {
        below += other[p] < losses[m][p];
        equal += other[p] == losses[m][p];
      }
      out.mean_rank[m] += (below + 0.5 * (equal + 1)) / problems;
      const bool is_lowest = below == 0 && std::isfinite(losses[m][p]);
      out.lowest[m] += (is_lowest ? 1 : 0) / problems;
    }
}

MethodPair pair_of(const std::vector<std::vector<double>>& losses,
                   std::size_t a,
                   std::size_t b) {
  std::vector<double> differences;
  for (std::size_t p = 0; p < losses[a].size(); ++p)
    differences.push_back(decades_above(losses[a][p], losses[b][p]));
  return {a, b, signed_rank(differences)};
}

/// "lower on 32 %, higher on 16 % and equal on 52 %", without those that are
/// empty.
std::string listed(std::vector<std::string> parts) {
  std::erase(parts, "");
  std::string text;
  for (std::size_t k = 0; k < parts.size(); ++k)
    text += (k == 0 ? "" : k + 1 == parts.size() ? " and " : ", ") + parts[k];
  return text;
}

/// The first method and those that end equal with it on every problem.
std::vector<std::size_t> ties_of_first(const Standings& s) {
  std::vector<std::size_t> equal{s.order.front()};
  for (const MethodPair& pair : s.pairs)
    if (pair.first == equal.front() && pair.test.ties == s.problems)
      equal.push_back(pair.second);
  return equal;
}

}  // namespace

Standings standings(const CommonRuns& common) {
  const auto losses = final_levels(common);
  Standings out;
  if (losses.size() < 2 || losses.front().empty()) return out;
  out.problems = losses.front().size();
  add_ranks(out, losses);
  out.order.resize(losses.size());
  std::iota(out.order.begin(), out.order.end(), std::size_t{0});
  std::stable_sort(out.order.begin(), out.order.end(), [&](auto a, auto b) {
    return out.mean_rank[a] < out.mean_rank[b];
  });
  std::vector<double> p;
  for (std::size_t i = 0; i < out.order.size(); ++i)
    for (std::size_t k = i + 1; k < out.order.size(); ++k) {
      out.pairs.push_back(pair_of(losses, out.order[i], out.order[k]));
      p.push_back(out.pairs.back().test.p);
    }
  const auto corrected = holm(p);
  for (std::size_t k = 0; k < p.size(); ++k) out.pairs[k].p = corrected[k];
  return out;
}

std::string standing_text(const CommonRuns& common,
                          const Standings& s,
                          const std::map<std::string, std::string>& titles) {
  if (s.pairs.empty()) return "";
  const auto title = [&](std::size_t m) {
    const auto found = titles.find(common.methods[m]);
    return found == titles.end() ? common.methods[m] : found->second;
  };
  const MethodPair& pair = s.pairs.front();
  const std::string first = title(pair.first), second = title(pair.second);
  const auto share = [&](const char* words, std::size_t count) {
    return count == 0 ? std::string()
                      : fmt::format("{} on {:.0f} %",
                                    words,
                                    100 * static_cast<double>(count) /
                                        static_cast<double>(s.problems));
  };
  const std::string shares = listed({share("lower", pair.test.below),
                                     share("higher", pair.test.above()),
                                     share("equal", pair.test.ties)});
  const std::string on = fmt::format("{} {}{}",
                                     s.problems,
                                     common.runs ? "run" : "problem",
                                     s.problems == 1 ? "" : "s");
  if (pair.test.ties == s.problems) {
    std::vector<std::string> equal;
    for (const std::size_t m : ties_of_first(s)) equal.push_back(title(m));
    return fmt::format(
        "{} of {} methods rank best and end with equal losses "
        "on {}: {}",
        equal.size(),
        s.order.size(),
        on,
        listed(equal));
  }
  if (pair.p >= kSignificant)
    return fmt::format(
        "No method is clearly ahead of the other{}: {} and {} rank best, and "
        "on {} the loss of {} is {} ({}, no significant difference)",
        s.order.size() > 2 ? "s" : "",
        first,
        second,
        on,
        first,
        shares,
        p_text(pair.p));
  return fmt::format(
      "{} ranks best of {} methods: on {} its final loss compared with {}, "
      "the next, is {} ({}{})",
      first,
      s.order.size(),
      on,
      second,
      shares,
      p_text(pair.p),
      pair.test.down ? "" : ", in favour of " + second);
}

}  // namespace physinv
