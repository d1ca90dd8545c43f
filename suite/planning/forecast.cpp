#include "suite/planning/forecast.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "suite/core/median.h"
#include "suite/harness/progress.h"
#include "suite/planning/kinds.h"
#include "suite/planning/memory.h"
#include "suite/planning/split.h"
#include "suite/planning/trials.h"
#include "suite/store/errors.h"

namespace physinv {
namespace {

/// Cases that differ in their seed alone.
using Same = std::tuple<const Method*, Index, Precision, std::vector<Index>>;
Same same(const Case& c) {
  return {c.method, c.info.n, c.info.precision, c.stage_iterations};
}

/// All of the chain's stages, or it is not known.
bool add_published(Cost& cost,
                   const Case& c,
                   const Durations& published,
                   double factor) {
  TimeRange sum;
  std::vector<double> stages;
  for (std::size_t k = 0; k < c.info.stages.size(); ++k) {
    const auto t = published.of(
        c.info.experiment, c.info.method, c.info.stages[k], c.operations(k));
    if (!t) return false;
    stages.push_back(factor * t->seconds);
    sum.seconds += stages.back();
    sum.least += factor * t->least;
    sum.most += factor * t->most;
  }
  cost.seconds = sum.seconds, cost.least = sum.least, cost.most = sum.most;
  cost.stage_seconds = std::move(stages);
  return true;
}

}  // namespace

std::vector<Cost> forecast(const std::vector<Case>& cases,
                           const Durations& published,
                           const Trials& trials,
                           double factor) {
  std::map<Kind, std::vector<Trial>> tried;
  for (const auto& [kind, sizes] : kinds_of(cases))
    tried[kind] = known_trials(sizes, trials);
  std::map<Same, Cost> known;  // seeds cost the same
  std::vector<Cost> costs;
  for (const Case& c : cases) {
    const auto [at, is_new] = known.try_emplace(same(c));
    Cost& cost = at->second;
    if (is_new) {
      cost = unmeasured_cost(c);
      const auto& own = tried.at(kind_of(c));
      if (!add_published(cost, c, published, factor) && !own.empty())
        cost = cost_of(c, own);
    }
    costs.push_back(cost);
  }
  return costs;
}

void add_memory(std::vector<Cost>& costs,
                const std::vector<Case>& cases,
                const Durations& published) {
  Memory memory(published);
  std::map<Same, double> known;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto [at, is_new] = known.try_emplace(same(cases[i]));
    if (is_new) at->second = memory.of(cases[i]);
    costs[i].memory = std::max(costs[i].memory, at->second);
  }
}

std::string about_text(const std::vector<Case>& cases,
                       int workers,
                       const std::filesystem::path& durations) {
  constexpr double kLittle = 1e10;
  Operations operations;
  double sum = 0;
  for (const Case& c : cases) sum += operations.of(c);
  if (sum < kLittle) return "";
  try {
    const double seconds = seconds_with(
        forecast(cases, Durations::read(durations), Trials(), machine_factor()),
        workers);
    return seconds >= 0 ? ", about " + duration_text(seconds) : "";
  } catch (const StoreError&) {  // a table that is none; plan says so
    return "";
  }
}

double seconds_with(const std::vector<Cost>& costs, int workers) {
  std::vector<double> seconds;
  for (const Cost& c : costs) {
    if (!std::isfinite(c.seconds)) return c.seconds;
    seconds.push_back(c.seconds);
  }
  return split_longest_first(seconds, static_cast<std::size_t>(workers))
      .longest;
}

std::vector<double> weights_of(const std::vector<Case>& cases,
                               const std::vector<Cost>& costs) {
  Operations operations;
  std::vector<double> rates;
  for (std::size_t i = 0; i < cases.size(); ++i)
    if (const double work = operations.of(cases[i]);
        work > 0 && std::isfinite(costs[i].seconds))
      rates.push_back(costs[i].seconds / work);
  const double rate = rates.empty() ? 1e-10 : median_high(rates);
  std::vector<double> weights;
  for (std::size_t i = 0; i < cases.size(); ++i)
    weights.push_back(std::isfinite(costs[i].seconds)
                          ? costs[i].seconds
                          : rate * operations.of(cases[i]));
  return weights;
}

}  // namespace physinv
