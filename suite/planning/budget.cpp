#include "suite/planning/budget.h"

#include <algorithm>
#include <set>
#include <tuple>

namespace physinv {
namespace {

/// Runs that are ranked against each other.
using Group = std::pair<std::string, Index>;

Group group_of(const Case& c) { return {c.info.experiment, c.info.n}; }

/// 0 for the first seed of a chain and n, 1 for the next.
std::vector<std::size_t> seed_ranks(const std::vector<Case>& cases) {
  std::map<std::tuple<std::string, std::string, Index>, std::set<std::uint64_t>>
      seeds;
  const auto id = [](const Case& c) {
    return std::tuple(c.info.experiment, c.info.method, c.info.n);
  };
  for (const Case& c : cases) seeds[id(c)].insert(c.info.seed);
  std::vector<std::size_t> ranks;
  for (const Case& c : cases) {
    const auto& all = seeds.at(id(c));
    ranks.push_back(static_cast<std::size_t>(
        std::distance(all.begin(), all.find(c.info.seed))));
  }
  return ranks;
}

std::set<Group> undecided_groups(const std::vector<Case>& cases,
                                 const Finished& finished) {
  std::map<Group, std::map<std::string, std::vector<double>>> losses;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto& own = losses[group_of(cases[i])][cases[i].info.method];
    if (const auto at = finished.find(i); at != finished.end())
      own.push_back(at->second);
  }
  std::set<Group> open;
  for (const auto& [group, methods] : losses) {
    std::vector<std::vector<double>> all;
    for (const auto& [method, values] : methods) all.push_back(values);
    if (undecided(all)) open.insert(group);
  }
  return open;
}

}  // namespace

bool undecided(const std::vector<std::vector<double>>& losses_by_method) {
  std::vector<std::pair<double, double>> ranges;
  for (const auto& losses : losses_by_method) {
    if (losses.size() < 2) return true;
    const auto [low, high] = std::minmax_element(losses.begin(), losses.end());
    ranges.emplace_back(*low, *high);
  }
  std::sort(ranges.begin(), ranges.end());
  for (std::size_t i = 1; i < ranges.size(); ++i)
    if (ranges[i].first <= ranges[i - 1].second) return true;
  return false;
}

std::vector<std::size_t> budget_order(const std::vector<Case>& cases,
                                      std::vector<std::size_t> queue,
                                      const Finished& finished,
                                      const std::vector<double>& seconds) {
  const auto ranks = seed_ranks(cases);
  const auto open = undecided_groups(cases, finished);
  const auto place = [&](std::size_t i) {
    const bool decided = ranks[i] > 0 && !open.contains(group_of(cases[i]));
    return std::tuple(decided, ranks[i], seconds[i]);
  };
  std::stable_sort(queue.begin(), queue.end(), [&](auto a, auto b) {
    return place(a) < place(b);
  });
  return queue;
}

}  // namespace physinv
