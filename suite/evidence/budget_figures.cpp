#include "suite/evidence/budget_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "suite/evidence/guests.h"
#include "suite/evidence/statistics.h"
#include "suite/results/published.h"

namespace physinv {
namespace {

constexpr double kSolvedTolerance = 1e-5;
constexpr std::size_t kMostPanels = 4, kMostCurves = 24;

std::vector<Index> some_of(const std::vector<Index>& sizes) {
  if (sizes.size() <= kMostPanels) return sizes;
  std::vector<Index> some;
  for (std::size_t k = 0; k < kMostPanels; ++k)
    some.push_back(sizes[k * (sizes.size() - 1) / (kMostPanels - 1)]);
  return some;
}

/// Mean losses over what was spent: simulations per problem, or seconds.
struct MeanCurve {
  std::vector<double> spent, loss;
  bool spread = false;  ///< see ConvergenceHistory
  /// At the last point up to there; empty before the first.
  std::optional<double> at(double x) const {
    const auto after = std::upper_bound(spent.begin(), spent.end(), x);
    if (after == spent.begin()) return {};
    return loss[static_cast<std::size_t>(after - spent.begin()) - 1];
  }
};
/// Of each seed, and what methods are called.
using Curves = std::vector<std::pair<std::string, std::vector<MeanCurve>>>;

MeanCurve curve_of(const ConvergenceHistory& history, Index n, bool seconds) {
  MeanCurve curve{.spread = !seconds && history.spread};
  for (std::size_t k = 0; k < history.loss.size(); ++k) {
    // A run that is judged by a mean is one problem.
    const Index problems = history.loss[k].size();
    const double share = problems == 1 ? 1 : static_cast<double>(n);
    // A logarithmic axis has no place for the start.
    if (seconds && !(history.seconds[k] > 0)) continue;
    curve.spent.push_back(seconds
                              ? history.seconds[k]
                              : std::max(history.simulations[k] / share, 1.0));
    curve.loss.push_back(history.loss[k].mean());
  }
  return curve;
}

Series series_of(const std::vector<MeanCurve>& seeds) {
  std::set<double> points;
  for (const MeanCurve& curve : seeds)
    points.insert(curve.spent.begin(), curve.spent.end());
  Series s;
  for (const double x : points) {
    std::vector<double> values;
    for (const MeanCurve& curve : seeds)
      if (const auto loss = curve.at(x)) values.push_back(*loss);
    const double middle = median(values), hi = quantile(values, 0.9);
    if (!std::isfinite(middle)) continue;
    s.x.push_back(x);
    s.y.push_back(middle);
    s.lo.push_back(quantile(values, 0.1));
    s.hi.push_back(std::isfinite(hi) ? hi : middle);
  }
  return s;
}

std::vector<std::string> drawn_methods(const Results& results,
                                       const std::string& experiment) {
  auto all = results.methods(experiment);
  if (all.size() <= kMostCurves) return all;
  const auto lowest = lowest_methods(results, experiment, kMostCurves);
  const auto added = guests({results, {}, experiment});
  std::erase_if(all, [&](const std::string& method) {
    return std::ranges::find(lowest, method) == lowest.end() &&
           std::ranges::find(added, method) == added.end();
  });
  return all;
}

std::string title_of(const std::string& method, const ProfileOptions& options) {
  const auto title = options.method_titles.find(method);
  return title == options.method_titles.end() ? method : title->second;
}

/// Of the methods that have losses at this n.
Curves curves_of(const Results& results,
                 const std::string& experiment,
                 Index n,
                 bool seconds) {
  Curves all;
  for (const std::string& method : drawn_methods(results, experiment)) {
    std::vector<MeanCurve> seeds;
    for (const auto seed : results.seeds(experiment)) {
      const auto* found = results.find_case(experiment, method, n, seed);
      const auto history = found ? history_of(*found) : std::nullopt;
      if (history && !history->loss.empty())
        seeds.push_back(curve_of(*history, n, seconds));
    }
    if (!seeds.empty()) all.emplace_back(method, std::move(seeds));
  }
  return all;
}

/// Are simulations counted along any curve, to its middle? Problems of a
/// formula have none, and a training counts them only at its end.
bool simulate(const Curves& all) {
  return std::ranges::any_of(all, [](const auto& method) {
    return std::ranges::any_of(method.second, [](const MeanCurve& curve) {
      return !curve.spread && !curve.spent.empty() &&
             curve.spent[curve.spent.size() / 2] > 1;
    });
  });
}

Panel curves_panel(const Results& results,
                   const std::string& experiment,
                   Index n,
                   const ProfileOptions& options) {
  Curves all = curves_of(results, experiment, n, false);
  const bool simulations = simulate(all);
  if (!simulations) all = curves_of(results, experiment, n, true);
  Panel panel{.title = fmt::format("n = {}", n),
              .x_label = simulations ? "simulations per problem" : "seconds",
              .y_label = "mean loss",
              .x_log = true,
              .y_log = true};
  for (const auto& [method, seeds] : all) {
    Series s = series_of(seeds);
    s.label = title_of(method, options), s.method = method;
    if (!s.x.empty()) panel.series.push_back(std::move(s));
  }
  return panel;
}

}  // namespace

Figure solved_by_budget(const CommonRuns& common,
                        const ProfileOptions& options) {
  Figure figure{
      .id = "solved_by_budget",
      .title = options.title + ": problems solved with a budget",
      .note = fmt::format(
          "Share of problems whose loss has come within tau = {:g} of the way "
          "from f_0, the lowest loss at which any method starts, to f_L, the "
          "lowest that any method found.",
          kSolvedTolerance)};
  if (common.methods.size() < 2) return figure;
  for (const Index n : some_of(common.sizes)) {
    const TargetCosts costs = target_costs(common, kSolvedTolerance, n);
    if (costs.problems == 0) continue;
    const bool simulations = any_simulated(costs.simulations);
    Panel panel = cost_panel(simulations ? costs.simulations : costs.seconds,
                             costs.methods,
                             options.method_titles);
    panel.title = fmt::format("n = {}", n);
    panel.x_label = simulations ? "simulations per problem" : "seconds";
    panel.y_label = "share of problems solved";
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Figure learning_curves(const Results& results,
                       const std::string& experiment,
                       const ProfileOptions& options) {
  Figure figure{.id = "learning_curves",
                .title = options.title + ": losses of all methods",
                .note =
                    "Mean over problems, median over seeds, band: 10 % and 90 "
                    "% quantiles. All stages of a method, also refinement; "
                    "simulations include gradients, Jacobians and inverses. "
                    "Where a method learns from "
                    "samples before its first simulation, its curve begins at "
                    "1. Seconds where nothing is simulated."};
  for (const Index n : some_of(results.sizes(experiment))) {
    Panel panel = curves_panel(results, experiment, n, options);
    if (!panel.series.empty()) figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace physinv
