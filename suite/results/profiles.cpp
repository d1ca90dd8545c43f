#include "suite/results/profiles.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "suite/core/median.h"
#include "suite/results/course.h"

namespace physinv {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Steps nearer than this factor are drawn as one; nobody sees less.
constexpr double kNearest = 1.02;

/// The chains of all methods on the same problems.
struct Group {
  Index n = 0, examples = 0;
  std::vector<Course> courses;
};

std::optional<Group> group_of(const Results& results,
                              const std::string& experiment,
                              const std::vector<std::string>& methods,
                              Index n,
                              std::uint64_t seed,
                              bool& crowded) {
  Group group{.n = n};
  bool some_crowded = false;
  for (const auto& method : methods) {
    const CaseRecord* found = results.find_case(experiment, method, n, seed);
    if (found == nullptr) return {};
    auto course = course_of(*found);
    if (!course) return {};
    for (const auto& loss : course->loss) {
      if (group.examples == 0) group.examples = loss.size();
      if (loss.size() != group.examples) return {};  // not the same problems
    }
    for (const auto& s : found->stages) some_crowded |= s.crowded;
    group.courses.push_back(std::move(*course));
  }
  crowded |= some_crowded;
  return group;
}

/// Loss to reach; empty if a method starts there or nobody has a number.
std::optional<double> target_of(const Group& group,
                                Index example,
                                double tolerance) {
  double start = kInfinity, lowest = kInfinity;
  for (const Course& course : group.courses) {
    for (std::size_t k = 0; k < course.loss.size(); ++k) {
      const double loss = course.loss[k][example];
      if (!std::isfinite(loss)) continue;
      if (k == 0) start = std::min(start, loss);
      lowest = std::min(lowest, loss);
    }
  }
  if (!std::isfinite(start)) return {};
  const double target = lowest + tolerance * (start - lowest);
  if (start <= target) return {};
  return target;
}

/// Those of `all` that end lowest, in the order of `all`.
std::vector<std::string> lowest_of(const Results& results,
                                   const std::string& experiment,
                                   const std::vector<std::string>& all,
                                   std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<std::pair<double, std::size_t>> ends;
  for (std::size_t m = 0; m < all.size(); ++m) {
    std::vector<double> last;
    for (const Index n : results.sizes(experiment))
      for (const std::uint64_t seed : results.seeds(experiment))
        if (const auto* found = results.find_case(experiment, all[m], n, seed))
          if (const auto course = course_of(*found);
              course && !course->loss.empty())
            last.push_back(course->loss.back().mean());
    for (double& loss : last)
      if (!std::isfinite(loss)) loss = kInfinity;
    ends.emplace_back(last.empty() ? kInfinity : median(std::move(last)), m);
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

void append_costs(TargetCosts& out,
                  const Group& group,
                  Index example,
                  double target) {
  const double share = out.runs ? 1 : static_cast<double>(group.n);
  for (std::size_t m = 0; m < group.courses.size(); ++m) {
    const Course& course = group.courses[m];
    const auto there =
        std::find_if(course.loss.begin(), course.loss.end(), [&](auto& loss) {
          return loss[example] <= target;
        });
    const bool reached = there != course.loss.end();
    const auto k = static_cast<std::size_t>(there - course.loss.begin());
    out.seconds[m].push_back(reached ? std::max(course.seconds[k], 1e-9)
                                     : kInfinity);
    out.simulations[m].push_back(
        reached ? std::max(course.simulations[k] / share, 1.0) : kInfinity);
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

Panel panel_of(const std::vector<Costs>& values,
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

std::string tolerance_text(double tolerance) {
  return fmt::format("tau = {:g}", tolerance);
}

std::string target_note(const TargetCosts& costs) {
  std::string note = fmt::format(
      "A problem ({}) is solved to tau once its "
      "loss is at most f_L + tau (f_0 - f_L), f_L the lowest loss any method "
      "found for it, f_0 the lowest at which any method starts (More and Wild "
      "2009). {} problems of n = {} and {} seed{}; {} more start there or "
      "without a number and are left out. Costs are those of the whole chain "
      "of stages, refinement included. {}",
      costs.runs ? "one run: the mean test loss of one seed"
                 : "one example of one n and seed",
      costs.problems,
      fmt::join(costs.sizes, ", "),
      costs.seeds,
      costs.seeds == 1 ? "" : "s",
      costs.solved_at_start,
      costs.runs
          ? "Simulations are those of training, gradients included."
          : "Curves hold the times of a batch: an example's seconds are the "
            "batch's when it first meets its target. Simulations, gradients "
            "included, are the batch's at that time over n, at least 1; those "
            "behind labelled training samples are not counted.");
  if (costs.left_out > 0)
    note +=
        fmt::format(" The {} methods that end lowest; {} more are left out.",
                    costs.methods.size(),
                    costs.left_out);
  if (costs.crowded) {
    note += " Some stages shared their cores: their seconds are too many.";
  }
  return note;
}

}  // namespace

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

TargetCosts target_costs(const Results& results,
                         const std::string& experiment,
                         double tolerance,
                         std::size_t most) {
  TargetCosts out;
  const auto all = results.methods(experiment);
  out.methods = lowest_of(results, experiment, all, most);
  out.left_out = static_cast<Index>(all.size() - out.methods.size());
  out.seconds.resize(out.methods.size());
  out.simulations.resize(out.methods.size());
  std::set<std::uint64_t> seeds;
  std::set<Index> sizes;
  for (const Index n : results.sizes(experiment)) {
    for (const std::uint64_t seed : results.seeds(experiment)) {
      const auto group =
          group_of(results, experiment, out.methods, n, seed, out.crowded);
      if (!group) continue;
      out.runs = group->examples == 1 && n > 1;
      seeds.insert(seed);
      sizes.insert(n);
      for (Index i = 0; i < group->examples; ++i) {
        const auto target = target_of(*group, i, tolerance);
        if (target) {
          append_costs(out, *group, i, *target);
        } else {
          ++out.solved_at_start;
        }
      }
    }
  }
  out.sizes.assign(sizes.begin(), sizes.end());
  out.seeds = static_cast<Index>(seeds.size());
  return out;
}

std::vector<Figure> profile_figures(const Results& results,
                                    const std::string& experiment,
                                    const ProfileOptions& options) {
  Figure profile{.id = "performance_profile",
                 .title = options.title + ": performance profiles"};
  Figure reached{.id = "time_to_target",
                 .title = options.title + ": time to target"};
  std::string note;
  for (const double tolerance : options.tolerances) {
    const TargetCosts costs = target_costs(results, experiment, tolerance);
    if (costs.methods.size() < 2 || costs.sizes.empty()) {
      profile.note = reached.note =
          costs.methods.size() < 2
              ? "Not made: only one method was run."
              : "Not made: no n and seed at which every method is finished "
                "and has the losses of the same problems.";
      profile.panels = reached.panels = {Panel{}};
      return {std::move(profile), std::move(reached)};
    }
    if (note.empty()) note = target_note(costs);
    for (const bool by_time : {true, false}) {
      const auto& spent = by_time ? costs.seconds : costs.simulations;
      Panel panel = panel_of(
          performance_ratios(spent), costs.methods, options.method_titles);
      panel.title = fmt::format("By {}, {}",
                                by_time ? "wall time" : "simulations",
                                tolerance_text(tolerance));
      panel.x_label = by_time ? "seconds over the best method's"
                              : "simulations over the best method's";
      panel.y_label = "share of problems";
      profile.panels.push_back(std::move(panel));

      panel = panel_of(spent, costs.methods, options.method_titles);
      panel.title = fmt::format("By {}, {}",
                                by_time ? "wall time" : "simulations",
                                tolerance_text(tolerance));
      panel.x_label = by_time ? "seconds" : "simulations per problem";
      panel.y_label = "share of problems solved";
      reached.panels.push_back(std::move(panel));
    }
  }
  profile.note =
      "Share of problems that a method solves within a factor of what the "
      "best method needs for the same problem (Dolan and More 2002); a method "
      "that fails never counts. The left end is the share of problems where "
      "a method is fastest, the right end the share it solves at all. " +
      note;
  reached.note =
      "Share of problems solved after so many seconds or simulations. " + note;
  return {std::move(profile), std::move(reached)};
}

}  // namespace physinv
