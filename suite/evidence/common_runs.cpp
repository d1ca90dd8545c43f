#include "suite/evidence/common_runs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "suite/core/median.h"

namespace physinv {
namespace {

constexpr double kHighest = std::numeric_limits<double>::infinity();

std::optional<CommonRun> common_run(const Results& results,
                                    const std::string& experiment,
                                    const std::vector<std::string>& methods,
                                    Index n,
                                    std::uint64_t seed,
                                    bool& crowded) {
  CommonRun group{.n = n};
  bool some_crowded = false;
  for (const auto& method : methods) {
    const CaseRecord* found = results.find_case(experiment, method, n, seed);
    if (found == nullptr) return {};
    auto history = history_of(*found);
    if (!history) return {};
    for (const auto& loss : history->loss) {
      if (group.examples == 0) group.examples = loss.size();
      if (loss.size() != group.examples) return {};  // not the same problems
    }
    for (const auto& s : found->stages) some_crowded |= s.crowded;
    group.histories.push_back(std::move(*history));
  }
  crowded |= some_crowded;
  return group;
}

double mean_final_loss(const ConvergenceHistory& history) {
  double sum = 0;
  const Index examples = history.loss.empty() ? 0 : history.loss.back().size();
  for (Index i = 0; i < examples; ++i) sum += final_loss(history, i);
  return examples == 0 ? kHighest : sum / static_cast<double>(examples);
}

}  // namespace

double final_loss(const ConvergenceHistory& history, Index i) {
  if (history.failed || history.loss.empty()) return kHighest;
  const double loss = history.loss.back()[i];
  return std::isfinite(loss) ? loss : kHighest;
}

std::vector<std::string> lowest_methods(const Results& results,
                                        const std::string& experiment,
                                        std::size_t most) {
  const auto all = results.methods(experiment);
  if (all.size() <= most) return all;
  std::vector<std::pair<double, std::size_t>> ends;
  for (std::size_t m = 0; m < all.size(); ++m) {
    std::vector<double> last;
    for (const Index n : results.sizes(experiment))
      for (const std::uint64_t seed : results.seeds(experiment))
        if (const auto* found = results.find_case(experiment, all[m], n, seed))
          if (const auto history = history_of(*found))
            last.push_back(mean_final_loss(*history));
    ends.emplace_back(last.empty() ? kHighest : median(std::move(last)), m);
  }
  std::sort(ends.begin(), ends.end());
  ends.resize(most);
  std::sort(ends.begin(), ends.end(), [](const auto& a, const auto& b) {
    return a.second < b.second;
  });
  std::vector<std::string> some;
  for (const auto& [end, m] : ends) some.push_back(all[m]);
  return some;
}

CommonRuns common_runs(const Results& results,
                       const std::string& experiment,
                       std::size_t most) {
  CommonRuns out;
  const auto all = results.methods(experiment);
  out.methods = lowest_methods(results, experiment, most);
  out.left_out = static_cast<Index>(all.size() - out.methods.size());
  std::set<std::uint64_t> seeds;
  std::set<Index> sizes;
  for (const Index n : results.sizes(experiment)) {
    for (const std::uint64_t seed : results.seeds(experiment)) {
      auto group =
          common_run(results, experiment, out.methods, n, seed, out.crowded);
      if (!group) continue;
      out.runs |= group->examples == 1 && n > 1;
      seeds.insert(seed);
      sizes.insert(n);
      out.groups.push_back(std::move(*group));
    }
  }
  // Where all methods failed at once, the number of problems is not known.
  for (CommonRun& group : out.groups)
    if (group.examples == 0) group.examples = out.runs ? 1 : group.n;
  out.sizes.assign(sizes.begin(), sizes.end());
  out.seeds = static_cast<Index>(seeds.size());
  return out;
}

}  // namespace physinv
