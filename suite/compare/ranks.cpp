#include "suite/compare/ranks.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "suite/evidence/statistics.h"
#include "suite/results/shortened.h"

namespace physinv {
namespace {

/// Side, experiment, method, stage.
using Key = std::tuple<std::size_t, std::string, std::string, std::string>;
using Differences = std::map<Key, std::vector<double>>;

/// Of the same problems; none if they are not the same.
std::vector<double> differences_of(const StageRecord& first,
                                   const StageRecord& other) {
  const Index count = std::max(first.loss.size(), other.loss.size());
  const auto loss = [&](const StageRecord& s, Index i) {
    return s.loss.size() == 0 ? kInfinite : s.loss[i];
  };
  for (const StageRecord* s : {&first, &other})
    if (s->loss.size() != 0 && s->loss.size() != count) return {};
  std::vector<double> all;
  for (Index i = 0; i < count; ++i)
    all.push_back(decades_above(loss(other, i), loss(first, i)));
  return all;
}

/// With or without a result; null if it was not run.
const StageRecord* same_stage(const Results& results,
                              const CaseInfo& info,
                              const std::string& name) {
  const CaseRecord* c =
      results.find_case(info.experiment, info.method, info.n, info.seed);
  if (c == nullptr) return nullptr;
  for (const StageRecord& s : c->stages)
    if (s.stage == name) return &s;
  return nullptr;
}

Differences differences(const std::vector<Side>& sides) {
  Differences all;
  for (std::size_t s = 1; s < sides.size(); ++s)
    for (const CaseRecord& c : sides[s].results.cases())
      for (const StageRecord& stage : c.stages) {
        const StageRecord* first =
            same_stage(sides.front().results, c.info, stage.stage);
        if (first == nullptr) continue;
        auto& own = all[{s, c.info.experiment, c.info.method, stage.stage}];
        const auto more = differences_of(*first, stage);
        own.insert(own.end(), more.begin(), more.end());
      }
  return all;
}

}  // namespace

std::vector<SideRank> side_ranks(const std::vector<Side>& sides) {
  std::vector<SideRank> ranks;
  std::vector<double> p;
  for (const auto& [key, all] : differences(sides)) {
    if (all.empty()) continue;
    SideRank rank{.test = signed_rank(all)};
    std::tie(rank.side, rank.experiment, rank.method, rank.stage) = key;
    p.push_back(rank.test.p);
    ranks.push_back(std::move(rank));
  }
  const auto corrected = holm(p);
  for (std::size_t k = 0; k < ranks.size(); ++k) ranks[k].p = corrected[k];
  std::stable_sort(ranks.begin(), ranks.end(), [](auto& a, auto& b) {
    return std::pair(a.p, a.test.p) < std::pair(b.p, b.test.p);
  });
  return ranks;
}

Table rank_table(const std::vector<SideRank>& ranks,
                 const std::vector<std::string>& labels,
                 std::size_t most) {
  Table table{.id = "rank_test",
              .title = "Which losses are lower",
              .digits = 0,
              .corner = "stage",
              .columns = {"problems",
                          "lower, %",
                          "higher, %",
                          "p",
                          "p by Holm",
                          "against " + shortened(labels.front(), 24)}};
  for (const SideRank& r : ranks) {
    if (table.rows.size() == most) break;
    const double share = 100 / static_cast<double>(r.test.pairs);
    std::string name = r.experiment + "/" + r.method + " " + r.stage;
    if (labels.size() > 2) name += ", " + shortened(labels[r.side], 24);
    table.rows.push_back(
        {std::move(name),
         {{.ours = static_cast<double>(r.test.pairs)},
          {.ours = share * static_cast<double>(r.test.below)},
          {.ours = share * static_cast<double>(r.test.above())},
          {.ours = r.test.p, .text = fmt::format("{:.2g}", r.test.p)},
          {.ours = r.p, .text = fmt::format("{:.2g}", r.p)},
          {.text = !r.differs() ? "no difference shown"
                   : r.better() ? "lower"
                                : "higher"}}});
  }
  table.note = fmt::format(
      "Wilcoxon's signed rank test of the ratios of losses over all examples "
      "of all n and seeds, two-sided, ties dropped, p corrected by Holm over "
      "{} stages; losses below {:g} are equal, below p = {:g} it is a "
      "difference. Problems of one network are not independent.",
      ranks.size(),
      kEqualLoss,
      kSignificant);
  if (ranks.size() > table.rows.size())
    table.note += fmt::format(" {} more stages differ less surely.",
                              ranks.size() - table.rows.size());
  return table;
}

}  // namespace physinv
