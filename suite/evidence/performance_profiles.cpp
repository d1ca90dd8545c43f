#include "suite/evidence/performance_profiles.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "suite/core/power_of_ten.h"

namespace physinv {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
/// Steps nearer than this factor are drawn as one; smaller steps are not
/// visible.
constexpr double kNearest = 1.02;

/// Loss to reach; empty if a method starts there or none has a number.
std::optional<double> target_of(const CommonRun& group,
                                Index example,
                                double tolerance) {
  const auto range = loss_range(group, example);
  if (!range) return {};
  const double target =
      range->lowest + tolerance * (range->start - range->lowest);
  if (range->start <= target) return {};
  return target;
}

void append_costs(TargetCosts& out,
                  const CommonRun& group,
                  Index example,
                  double target) {
  const double share = out.runs ? 1 : static_cast<double>(group.n);
  for (std::size_t m = 0; m < group.histories.size(); ++m) {
    const ConvergenceHistory& history = group.histories[m];
    const auto there =
        std::find_if(history.loss.begin(), history.loss.end(), [&](auto& loss) {
          return loss[example] <= target;
        });
    if (there == history.loss.end()) {
      out.seconds[m].push_back(kInfinity);
      out.simulations[m].push_back(kInfinity);
      out.spent_seconds[m].push_back(history.all_seconds.value_or(kUnknown));
      out.spent_simulations[m].push_back(
          history.all_simulations.value_or(kUnknown) / share);
      continue;
    }
    const auto k = static_cast<std::size_t>(there - history.loss.begin());
    out.seconds[m].push_back(std::max(history.seconds[k], 1e-9));
    out.simulations[m].push_back(std::max(history.simulations[k] / share, 1.0));
    out.spent_seconds[m].push_back(out.seconds[m].back());
    out.spent_simulations[m].push_back(out.simulations[m].back());
  }
  ++out.problems;
}

// The stairs as a line from `first` to `last`, at `before` ahead of the steps.
void draw_steps(Series& series, const Steps& steps, double first, double last) {
  double level = 0;
  const auto point = [&](double x, double y) {
    series.x.push_back(x);
    series.y.push_back(y);
  };
  std::size_t k = 0;
  while (k < steps.x.size() && steps.x[k] <= first) level = steps.y[k++];
  point(first, level);
  while (k < steps.x.size()) {
    std::size_t end = k;
    while (end + 1 < steps.x.size() &&
           steps.x[end + 1] < kNearest * steps.x[k]) {
      ++end;
    }
    point(steps.x[end], level);
    level = steps.y[end];
    point(steps.x[end], level);
    k = end + 1;
  }
  if (series.x.back() < last) point(last, level);
}

std::string tolerance_text(double tolerance) {
  return fmt::format("tau = {:g}", tolerance);
}

std::string target_note(const TargetCosts& costs) {
  std::string note = fmt::format(
      "A problem ({}) is solved to tau when its loss is at most f_L + tau (f_0 "
      "- f_L) (More and Wild 2009): f_L is the lowest loss that any method "
      "found for it, f_0 the lowest loss at which any method starts. {} "
      "problems of n = {} and {} seed{}; {} more are left out because they "
      "start at the target or without a finite loss. Costs include all stages, "
      "also refinement. {}",
      costs.runs ? "one run: the mean test loss of one seed"
                 : "one example of one n and seed",
      costs.problems,
      fmt::join(costs.sizes, ", "),
      costs.seeds,
      costs.seeds == 1 ? "" : "s",
      costs.solved_at_start,
      costs.runs
          ? "Simulations are those of training and include gradients."
          : "Curves record the times of a batch: the time of an example is the "
            "time of its batch when the example first reaches the target. "
            "Simulations include gradients; they are those of the batch at "
            "that time divided by n, at least 1. Simulations for labelled "
            "training samples are not counted.");
  if (costs.left_out > 0)
    note += fmt::format(
        " Only the {} methods with the lowest final losses; {} more are left "
        "out.",
        costs.methods.size(),
        costs.left_out);
  if (costs.crowded) {
    note += " Some stages shared their cores, so their times are too long.";
  }
  return note;
}

}  // namespace

std::optional<LossRange> loss_range(const CommonRun& group, Index example) {
  LossRange range{kInfinity, kInfinity};
  for (const ConvergenceHistory& history : group.histories) {
    for (std::size_t k = 0; k < history.loss.size(); ++k) {
      const double loss = history.loss[k][example];
      if (!std::isfinite(loss)) continue;
      if (k == 0) range.start = std::min(range.start, loss);
      range.lowest = std::min(range.lowest, loss);
    }
  }
  if (!std::isfinite(range.start)) return {};
  return range;
}

bool any_simulated(const std::vector<Costs>& simulations) {
  return std::ranges::any_of(simulations, [](const Costs& costs) {
    return std::ranges::any_of(
        costs, [](double c) { return std::isfinite(c) && c > 1; });
  });
}

Panel cost_panel(const std::vector<Costs>& values,
                 const std::vector<std::string>& methods,
                 const std::map<std::string, std::string>& titles) {
  Panel panel{.x_log = true, .y_min = 0, .y_max = 1};
  double first = kInfinity, last = 0;
  for (const Costs& one : values) {
    for (const double v : one) {
      if (!std::isfinite(v)) continue;
      first = std::min(first, v);
      last = std::max(last, v);
    }
  }
  if (last == 0) return panel;  // reads "not run"
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const auto title = titles.find(methods[m]);
    Series s{.label = title == titles.end() ? methods[m] : title->second,
             .method = methods[m]};
    draw_steps(s, distribution(values[m]), first, 1.1 * last);
    panel.series.push_back(std::move(s));
  }
  return panel;
}

std::vector<Costs> performance_ratios(const std::vector<Costs>& costs) {
  std::vector<Costs> ratios = costs;
  const std::size_t problems = costs.empty() ? 0 : costs.front().size();
  for (std::size_t p = 0; p < problems; ++p) {
    double best = kInfinity;
    for (const Costs& one : costs) best = std::min(best, one[p]);
    if (!std::isfinite(best)) continue;
    for (Costs& one : ratios) one[p] /= best;
  }
  return ratios;
}

Steps distribution(Costs values) {
  std::sort(values.begin(), values.end());
  Steps steps;
  const auto count = static_cast<double>(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!std::isfinite(values[k])) break;
    if (k + 1 < values.size() && values[k + 1] == values[k]) continue;
    steps.x.push_back(values[k]);
    steps.y.push_back(static_cast<double>(k + 1) / count);
  }
  return steps;
}

TargetCosts target_costs(const CommonRuns& common,
                         double tolerance,
                         std::optional<Index> n) {
  TargetCosts out{.methods = common.methods,
                  .runs = common.runs,
                  .left_out = common.left_out,
                  .sizes = common.sizes,
                  .seeds = common.seeds,
                  .crowded = common.crowded};
  for (auto* costs : {&out.seconds,
                      &out.simulations,
                      &out.spent_seconds,
                      &out.spent_simulations})
    costs->resize(out.methods.size());
  for (const CommonRun& group : common.groups) {
    if (n && group.n != *n) continue;
    for (Index i = 0; i < group.examples; ++i) {
      const auto target = target_of(group, i, tolerance);
      if (target) {
        append_costs(out, group, i, *target);
      } else {
        ++out.solved_at_start;
      }
    }
  }
  return out;
}

TargetCosts target_costs(const Results& results,
                         const std::string& experiment,
                         double tolerance,
                         std::size_t most) {
  return target_costs(common_runs(results, experiment, most), tolerance);
}

namespace {

/// Costs of all targets that are shared out evenly in their exponent, joined.
TargetCosts many_targets(const CommonRuns& common) {
  TargetCosts all;
  for (const double tolerance : distribution_targets()) {
    TargetCosts one = target_costs(common, tolerance);
    if (all.methods.empty()) {
      all = std::move(one);
      continue;
    }
    for (std::size_t m = 0; m < all.methods.size(); ++m) {
      const auto append = [m](auto& to, const auto& from) {
        to[m].insert(to[m].end(), from[m].begin(), from[m].end());
      };
      append(all.seconds, one.seconds);
      append(all.simulations, one.simulations);
    }
    all.problems += one.problems;
  }
  return all;
}

Figure distribution_figure(const CommonRuns& common,
                           const ProfileOptions& options) {
  const TargetCosts costs = many_targets(common);
  const auto targets = distribution_targets();
  Figure figure{
      .id = "runtime_distribution",
      .title = options.title + ": runtime distribution over all targets",
      .note = fmt::format(
          "Share of all (problem, target) pairs that a method has reached "
          "after a number of seconds or simulations: COCO's ECDF of run times "
          "(Hansen et al. 2021) over {} targets tau from {:.2g} to {:.2g} with "
          "evenly spaced exponents. Higher and further left is better. {} "
          "pairs.",
          targets.size(),
          targets.front(),
          targets.back(),
          costs.problems)};
  for (const bool by_time : {true, false}) {
    if (!by_time && !any_simulated(costs.simulations)) continue;
    Panel panel = cost_panel(by_time ? costs.seconds : costs.simulations,
                             costs.methods,
                             options.method_titles);
    panel.title = by_time ? "By wall time" : "By simulations";
    panel.x_label = by_time ? "seconds" : "simulations per problem";
    panel.y_label = "share of problems and targets";
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace

std::vector<double> distribution_targets() {
  constexpr int kTargets = 24, kPerDecade = 4;
  std::vector<double> all;
  for (int k = 1; k <= kTargets; ++k)
    all.push_back(math::power_of_ten(-static_cast<double>(k) / kPerDecade));
  return all;
}

std::vector<Figure> performance_profile_figures(const Results& results,
                                                const std::string& experiment,
                                                const ProfileOptions& options) {
  return performance_profile_figures(common_runs(results, experiment), options);
}

std::vector<Figure> performance_profile_figures(const CommonRuns& common,
                                                const ProfileOptions& options) {
  Figure profile{.id = "performance_profile",
                 .title = options.title + ": performance profiles"};
  Figure reached{.id = "time_to_target",
                 .title = options.title + ": time to target"};
  std::string note;
  for (const double tolerance : options.tolerances) {
    const TargetCosts costs = target_costs(common, tolerance);
    if (costs.methods.size() < 2 || costs.sizes.empty()) {
      profile.note = reached.note =
          costs.methods.size() < 2
              ? "Not drawn: only one method was run."
              : "Not drawn: there is no n and seed at which every method has "
                "finished with losses of the same problems.";
      profile.panels = reached.panels = {Panel{}};
      return {std::move(profile), std::move(reached)};
    }
    if (note.empty()) note = target_note(costs);
    for (const bool by_time : {true, false}) {
      if (!by_time && !any_simulated(costs.simulations)) continue;
      const auto& spent = by_time ? costs.seconds : costs.simulations;
      Panel panel = cost_panel(
          performance_ratios(spent), costs.methods, options.method_titles);
      panel.title = fmt::format("By {}, {}",
                                by_time ? "wall time" : "simulations",
                                tolerance_text(tolerance));
      panel.x_label = by_time ? "seconds / those of the best method"
                              : "simulations / those of the best method";
      panel.y_label = "share of problems";
      profile.panels.push_back(std::move(panel));

      panel = cost_panel(spent, costs.methods, options.method_titles);
      panel.title = fmt::format("By {}, {}",
                                by_time ? "wall time" : "simulations",
                                tolerance_text(tolerance));
      panel.x_label = by_time ? "seconds" : "simulations per problem";
      panel.y_label = "share of problems solved";
      reached.panels.push_back(std::move(panel));
    }
  }
  profile.note =
      "Share of problems that a method solves within a factor of the cost of "
      "the best method for the same problem (Dolan and More 2002). Failures "
      "are never solved. The left end is the share of problems on which a "
      "method is fastest, the right end the share that it solves. " +
      note;
  reached.note =
      "Share of problems solved after a number of seconds or simulations, "
      "solved as in the performance profiles.";
  return {std::move(profile),
          std::move(reached),
          distribution_figure(common, options)};
}

}  // namespace physinv
