#include "suite/evidence/work_precision.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "suite/evidence/cell.h"
#include "suite/evidence/convergence_history.h"
#include "suite/evidence/statistics.h"

namespace physinv {
namespace {

/// Shares of the way from the start to the lowest loss that are left.
constexpr double kTargets[] = {1e-1, 1e-2, 1e-3};
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A chain's mean losses over seconds per problem.
struct MeanHistory {
  std::vector<double> seconds, loss;
  std::optional<double> distance;
  bool crowded = false, failed = false;
};
using SettingKey = std::tuple<std::string, Index, Precision>;
using BySeed = std::map<std::uint64_t, MeanHistory>;

bool solves(const CaseRecord& c) {
  return std::none_of(c.stages.begin(), c.stages.end(), [](const auto& s) {
    return is_diagnostic(s.options);
  });
}

std::optional<double> distance_of(const CaseRecord& c, bool failed) {
  const Batch<double>& truth = c.data.x;
  const Batch<double>& x = c.stages.back().x;
  if (truth.rows() == 0) return {};
  if (failed) return kInfinite;
  if (x.rows() != truth.rows() || x.cols() == 0 || x.cols() > truth.cols())
    return {};
  std::vector<double> all;
  for (Index i = 0; i < x.cols(); ++i) {
    const double distance = (x.col(i) - truth.col(i)).norm();
    all.push_back(std::isfinite(distance) ? distance : kInfinite);
  }
  return median(std::move(all));
}

/// Over seconds per problem; what is not finite is infinite.
MeanHistory mean_of(const CaseRecord& c,
                    const ConvergenceHistory& history,
                    bool run) {
  MeanHistory mean{.distance = distance_of(c, history.failed),
                   .failed = history.failed};
  for (const StageRecord& s : c.stages) mean.crowded |= s.crowded;
  const double share = run ? 1 : static_cast<double>(c.info.n);
  const auto add = [&](double seconds, double loss) {
    mean.seconds.push_back(seconds / share);
    mean.loss.push_back(std::isfinite(loss) ? loss : kInfinite);
  };
  for (std::size_t k = 0; k < history.loss.size(); ++k)
    add(history.seconds[k], history.loss[k].mean());
  if (history.failed) add(history.all_seconds.value_or(kUnknown), kInfinite);
  return mean;
}

std::map<SettingKey, BySeed> mean_histories(const Results& results,
                                            const std::string& experiment) {
  std::vector<std::pair<const CaseRecord*, ConvergenceHistory>> found;
  bool runs = false;  // a method is judged by its network on a test set
  for (const CaseRecord& c : results.cases()) {
    if (c.info.experiment != experiment || !solves(c)) continue;
    auto history = history_of(c);
    if (!history || (history->loss.empty() && !history->failed)) continue;
    runs |= c.info.n > 1 && !history->loss.empty() &&
            history->loss.front().size() == 1;
    found.emplace_back(&c, std::move(*history));
  }
  std::map<SettingKey, BySeed> all;
  for (const auto& [c, history] : found)
    all[{c->info.method, c->info.n, c->info.precision}][c->info.seed] =
        mean_of(*c, history, runs);
  return all;
}

/// Of one n: the seeds that all settings have, and the lowest start of each.
struct Pairing {
  std::set<std::uint64_t> seeds;
  std::map<std::uint64_t, double> start;
};

std::map<Index, Pairing> pairings(const std::map<SettingKey, BySeed>& all) {
  std::map<Index, Pairing> out;
  std::set<Index> seen;
  for (const auto& [key, by_seed] : all) {
    const Index n = std::get<1>(key);
    Pairing& p = out[n];
    std::set<std::uint64_t> mine;
    for (const auto& [seed, history] : by_seed) {
      mine.insert(seed);
      const auto [at, is_new] = p.start.emplace(seed, history.loss.front());
      if (!is_new) at->second = std::min(at->second, history.loss.front());
    }
    if (seen.insert(n).second) {
      p.seeds = mine;
    } else {
      std::erase_if(p.seeds, [&](auto seed) { return !mine.contains(seed); });
    }
  }
  return out;
}

SettingHistory without_points(SettingHistory setting) {
  setting.points.clear();
  return setting;
}

SettingHistory setting_of(const SettingKey& key,
                          const BySeed& by_seed,
                          const Pairing& pairing) {
  SettingHistory out;
  std::tie(out.method, out.n, out.precision) = key;
  out.seeds = pairing.seeds.size();
  std::size_t points = 0;
  std::vector<double> distances;
  for (const auto seed : pairing.seeds) {
    const MeanHistory& c = by_seed.at(seed);
    points = std::max(points, c.loss.size());
    if (c.distance) distances.push_back(*c.distance);
    out.crowded |= c.crowded;
    out.failed += c.failed;
  }
  if (!distances.empty()) out.distance = median(std::move(distances));
  for (std::size_t k = 0; k < points; ++k) {
    std::vector<double> seconds, losses;
    for (const auto seed : pairing.seeds) {
      // A run that has ended stays where it is.
      const MeanHistory& c = by_seed.at(seed);
      const std::size_t at = std::min(k, c.loss.size() - 1);
      if (std::isnan(c.seconds[at])) return without_points(std::move(out));
      seconds.push_back(c.seconds[at]);
      losses.push_back(std::isfinite(c.loss[at])
                           ? c.loss[at] / pairing.start.at(seed)
                           : kInfinite);
    }
    out.end = {.seconds = median(seconds),
               .loss = median(losses),
               .low = quantile(losses, 0.1),
               .high = quantile(losses, 0.9)};
    if (std::isfinite(out.end.loss) && out.end.loss > 0)
      out.points.push_back(out.end);
  }
  return out;
}

/// Words of a setting; its precision where its method has both.
class Names {
 public:
  Names(const std::vector<SettingHistory>& settings,
        const std::map<std::string, std::string>& titles)
      : titles_(titles) {
    for (const SettingHistory& s : settings)
      precisions_[s.method].insert(s.precision);
  }
  std::string operator()(const SettingHistory& s) const {
    const auto title = titles_.find(s.method);
    std::string name = title == titles_.end() ? s.method : title->second;
    if (precisions_.at(s.method).size() > 1)
      name += s.precision == Precision::f64 ? ", double" : ", float";
    return name;
  }

 private:
  const std::map<std::string, std::string>& titles_;
  std::map<std::string, std::set<Precision>> precisions_;
};

std::string failed_words(const SettingHistory& s) {
  return fmt::format("{} of {} failed", s.failed, s.seeds);
}

Table table_of(const std::vector<SettingHistory>& settings,
               const std::vector<BudgetPoint>& hull,
               const Names& name_of) {
  const double lowest = hull.back().loss;
  Table table{
      .id = "run_time_against_loss",
      .title = "Run time against loss",
      .digits = 3,
      .corner = "setting",
      .columns = {"seeds", "seconds", "loss", "10 %", "90 %", "|x - x*|"},
      .keys = {"method", "n"}};
  std::vector<double> levels;
  for (const double target : kTargets) {
    levels.push_back(lowest + target * (1 - lowest));
    table.columns.push_back(fmt::format("s to {:.2g}", levels.back()));
  }
  table.columns.emplace_back("on the hull");
  std::vector<std::string> dominated, failed;
  bool crowded = false;
  for (const SettingHistory& s : settings) {
    const std::string name = fmt::format("{}, n = {}", name_of(s), s.n);
    TableRow row{.label = name, .keys = {name_of(s), std::to_string(s.n)}};
    row.cells.push_back(written(s.seeds, "{:g}"));
    if (s.failed > 0) failed.push_back(name + " " + failed_words(s));
    if (s.points.empty()) {
      row.cells.insert(row.cells.end(),
                       table.columns.size() - 1,
                       Cell{.text = s.seeds == 0   ? "no common seed"
                                    : s.failed > 0 ? failed_words(s)
                                                   : "no ratio"});
      table.rows.push_back(std::move(row));
      continue;
    }
    for (const double v : {s.end.seconds, s.end.loss, s.end.low, s.end.high})
      row.cells.push_back(written(v));
    row.cells.push_back(written(s.distance, "{:.3g}", kNothing));
    for (const double level : levels) {
      const double seconds = seconds_to(s, level);
      row.cells.push_back(std::isfinite(seconds) ? written(seconds)
                                                 : Cell{.text = "never"});
    }
    const bool good = on_hull(s, hull);
    row.cells.push_back({.text = good ? "yes" : "dominated"});
    if (!good) dominated.push_back(name);
    crowded |= s.crowded;
    table.rows.push_back(std::move(row));
  }
  table.note = fmt::format(
      "Values at the end of the budget: medians with 10 % and 90 % quantiles "
      "over the seeds that all settings of one n share. Seconds per problem "
      "(for a network judged on a test set, seconds of training); mean loss "
      "divided by the lowest loss at which any method starts. The targets "
      "leave 10, 1 and 0.1 % of the way from the start to the lowest loss "
      "found. The hull is the lower-left hull over all budgets. {}{}{}",
      dominated.empty() ? "No setting is dominated at every budget."
                        : fmt::format("Dominated at every budget: {}.",
                                      fmt::join(dominated, "; ")),
      failed.empty() ? ""
                     : fmt::format(" A failed run has an infinite loss after "
                                   "its failure: {}.",
                                   fmt::join(failed, "; ")),
      crowded ? " Some stages shared their cores, so their times are too long."
              : "");
  return table;
}

Series hull_series(const std::vector<BudgetPoint>& hull) {
  Series s{.label = "lower-left hull",
           .method = "hull",
           .dashed = true,
           .style = PlotStyle{.hue = Hue::ink}};
  for (const BudgetPoint& p : hull)
    s.x.push_back(p.seconds), s.y.push_back(p.loss);
  return s;
}

void append(Series& s, const BudgetPoint& p) {
  if (p.seconds <= 0) return;
  s.x.push_back(p.seconds), s.y.push_back(p.loss);
  s.lo.push_back(p.low), s.hi.push_back(p.high);
}

Figure figure_of(const std::vector<SettingHistory>& settings,
                 const std::vector<BudgetPoint>& hull,
                 const Names& name_of) {
  Index largest = 0;
  for (const SettingHistory& s : settings) largest = std::max(largest, s.n);
  const auto panel = [](std::string title) {
    return Panel{.title = std::move(title),
                 .x_label = "seconds per problem",
                 .y_label = "loss / loss at the start",
                 .x_log = true,
                 .y_log = true};
  };
  Panel budget = panel(fmt::format("Growing budget, n = {}", largest)),
        sizes = panel("Whole budget, all n");
  std::map<std::string, Series> ends;
  for (const SettingHistory& s : settings) {
    const std::string label = name_of(s);
    Series line{.label = label, .method = s.method};
    if (s.n == largest) {
      for (const BudgetPoint& p : s.points) append(line, p);
      budget.series.push_back(line);
    }
    auto [at, is_new] = ends.emplace(label, line);
    if (is_new)
      at->second = {.label = label, .method = s.method, .markers = true};
    if (!s.points.empty() && std::isfinite(s.end.loss))
      append(at->second, s.end);
  }
  for (auto& [label, series] : ends) sizes.series.push_back(std::move(series));
  for (Panel* p : {&budget, &sizes}) p->series.push_back(hull_series(hull));
  return {
      .id = "run_time_against_loss",
      .title = "Run time against loss",
      .panels = {std::move(budget), std::move(sizes)},
      .note =
          "Medians over seeds with 10 % and 90 % quantiles. Each point of a "
          "curve is the result of a smaller budget; the hull covers all "
          "settings and budgets."};
}

}  // namespace

std::vector<SettingHistory> setting_histories(const Results& results,
                                              const std::string& experiment) {
  const auto all = mean_histories(results, experiment);
  const auto pairs = pairings(all);
  std::vector<SettingHistory> out;
  for (const auto& [key, by_seed] : all)
    out.push_back(setting_of(key, by_seed, pairs.at(std::get<1>(key))));
  return out;
}

std::vector<BudgetPoint> work_precision_hull(
    const std::vector<SettingHistory>& settings) {
  std::vector<BudgetPoint> all, hull;
  for (const SettingHistory& s : settings)
    for (const BudgetPoint& p : s.points)
      if (p.seconds > 0) all.push_back(p);
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return std::pair(a.seconds, a.loss) < std::pair(b.seconds, b.loss);
  });
  for (const BudgetPoint& p : all)
    if (hull.empty() || p.loss < hull.back().loss) hull.push_back(p);
  return hull;
}

bool on_hull(const SettingHistory& setting,
             const std::vector<BudgetPoint>& hull) {
  return std::any_of(
      setting.points.begin(), setting.points.end(), [&](const auto& p) {
        return std::any_of(hull.begin(), hull.end(), [&](const auto& h) {
          return h.seconds == p.seconds && h.loss == p.loss;
        });
      });
}

double seconds_to(const SettingHistory& setting, double loss) {
  for (const BudgetPoint& p : setting.points)
    if (p.loss <= loss) return p.seconds;
  return kInfinite;
}

void add_work_precision(
    Section& section,
    const Results& results,
    const std::string& experiment,
    const std::map<std::string, std::string>& method_titles) {
  const auto settings = setting_histories(results, experiment);
  const auto hull = work_precision_hull(settings);
  if (hull.empty()) return;
  const Names name_of(settings, method_titles);
  section.tables.push_back(table_of(settings, hull, name_of));
  section.figures.push_back(figure_of(settings, hull, name_of));
}

}  // namespace physinv
