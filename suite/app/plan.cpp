#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "reports/plot.h"
#include "suite/app/load.h"
#include "suite/app/options.h"
#include "suite/app/speeds.h"
#include "suite/harness/columns.h"
#include "suite/harness/context.h"
#include "suite/harness/progress.h"
#include "suite/planning/forecast.h"
#include "suite/planning/split.h"
#include "suite/store/case_file.h"
#include "suite/store/file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

/// "12 s", "12 s, 3 not known" or "not known".
std::string time_text(const std::size_t cases,
                      const std::size_t unknown,
                      double seconds) {
  if (unknown == 0) return duration_text(seconds);
  if (unknown == cases) return "not known";
  return fmt::format("{}, {} not known", duration_text(seconds), unknown);
}

std::string bytes_text(double bytes) {
  return bytes < 1e6   ? fmt::format("{:.0f} kB", bytes / 1e3)
         : bytes < 1e9 ? fmt::format("{:.1f} MB", bytes / 1e6)
                       : fmt::format("{:.2f} GB", bytes / 1e9);
}

/// What a finished campaign took for a case; no stages if it lacks it.
Cost measured(const CaseRecord* record, const fs::path& directory) {
  Cost cost;
  if (record == nullptr || record->stages.size() < record->info.stages.size())
    return cost;
  for (const StageRecord& s : record->stages) {
    if (!(s.clocks.total().cpu >= 0)) return {};  // not known
    cost.stage_seconds.push_back(s.clocks.total().cpu);
    cost.seconds += cost.stage_seconds.back();
    cost.memory = std::max(cost.memory, static_cast<double>(s.rss_bytes));
  }
  std::error_code none;
  cost.disk = static_cast<double>(fs::file_size(
      directory / "cases" / case_file_name(record->info.name), none));
  return cost;
}

std::vector<Cost> measured(const std::vector<Case>& cases,
                           const std::string& directory) {
  const Loaded loaded = load(directory);
  std::vector<Cost> costs;
  for (const Case& c : cases)
    costs.push_back(
        measured(loaded.results.find_case(
                     c.info.experiment, c.info.method, c.info.n, c.info.seed),
                 directory));
  return costs;
}

/// Of what is known.
struct Sum {
  double seconds = 0, least = 0, most = 0, memory = 0, disk = 0;
  std::size_t unknown = 0;

  void add(const Cost& c) {
    if (std::isfinite(c.seconds))
      seconds += c.seconds, least += c.least, most += c.most;
    else
      ++unknown;
    memory = std::max(memory, c.memory);
    disk += c.disk;
  }
};

Sum sum_of(const std::vector<Cost>& costs) {
  Sum sum;
  for (const Cost& c : costs) sum.add(c);
  return sum;
}

/// One line of the table: a case, or all of an experiment.
struct Line {
  std::string name;
  std::size_t cases = 0, compared = 0;
  Sum sum;
  double predicted = 0, measured = 0;  ///< seconds of those compared
};

std::vector<Line> lines_of(const std::vector<Case>& cases,
                           const std::vector<Cost>& costs,
                           const std::vector<Cost>& beside,
                           bool each) {
  std::vector<Line> lines;
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto& info = cases[i].info;
    const auto& name = each ? info.name : info.experiment;
    const auto [at, is_new] = index.emplace(name, lines.size());
    if (is_new) lines.push_back({.name = name});
    Line& line = lines[at->second];
    ++line.cases;
    line.sum.add(costs[i]);
    if (beside.empty() || beside[i].stage_seconds.empty() ||
        !std::isfinite(costs[i].seconds))
      continue;
    ++line.compared;
    line.predicted += costs[i].seconds;
    line.measured += beside[i].seconds;
  }
  return lines;
}

void print_table(const std::vector<Line>& lines, bool compares) {
  std::vector<std::string> heads = {"<name", "cases", "time", "memory", "disk"};
  if (compares) heads.insert(heads.end(), {"measured", "factor"});
  Columns table(heads);
  for (const Line& line : lines) {
    std::vector<std::string> row = {
        line.name,
        std::to_string(line.cases),
        time_text(line.cases, line.sum.unknown, line.sum.seconds),
        bytes_text(line.sum.memory),
        bytes_text(line.sum.disk)};
    if (compares && line.compared > 0)
      row.insert(row.end(),
                 {duration_text(line.measured),
                  fmt::format("{:.2f}", line.predicted / line.measured)});
    table.add(std::move(row));
  }
  fmt::print("{}", table.text(Screen::of(stdout).room()));
}

/// Those whose time is known.
std::vector<Cost> known_of(const std::vector<Cost>& costs) {
  std::vector<Cost> known;
  for (const Cost& c : costs)
    if (std::isfinite(c.seconds)) known.push_back(c);
  return known;
}

void print_sum(const std::vector<Case>& cases, const std::vector<Cost>& costs) {
  const Sum sum = sum_of(costs);
  const int cores = available_cores();
  const auto known = known_of(costs);
  const std::string time =
      known.empty() ? "time unknown, --exact measures it"
                    : fmt::format(
                          "{} of one core (from {} to {}), {} with {} "
                          "workers",
                          duration_text(sum.seconds),
                          duration_text(sum.least),
                          duration_text(sum.most),
                          duration_text(seconds_with(known, cores)),
                          cores);
  fmt::print("{} cases: {}; {} on disk, at most {} per worker\n",
             costs.size(),
             time,
             bytes_text(sum.disk),
             bytes_text(sum.memory));
  if (known.empty()) return;
  std::size_t longest = 0;
  for (std::size_t i = 1; i < costs.size(); ++i)
    if (!std::isfinite(costs[longest].seconds) ||
        costs[i].seconds > costs[longest].seconds)
      longest = i;
  fmt::print("the longest of these cases, a lower bound: {}, {}\n",
             cases[longest].info.name,
             duration_text(costs[longest].seconds));
  if (sum.unknown > 0)
    fmt::print(
        "{} cases have no known time and are not in the sum; --exact measures "
        "it\n",
        sum.unknown);
}

/// How close the prediction was, case by case.
void print_factors(const std::vector<Cost>& costs,
                   const std::vector<Cost>& beside) {
  std::size_t compared = 0, close = 0;
  for (std::size_t i = 0; i < beside.size(); ++i) {
    if (beside[i].stage_seconds.empty()) continue;
    if (!std::isfinite(costs[i].seconds)) continue;
    const double factor = costs[i].seconds / beside[i].seconds;
    ++compared;
    if (factor <= 1.5 && factor >= 1 / 1.5) ++close;
  }
  if (compared == 0) return;
  fmt::print(
      "{} of {} cases within a factor of 1.5 of the measured time ({:.0f} %); "
      "in total {} predicted, {} measured\n",
      close,
      compared,
      100.0 * static_cast<double>(close) / static_cast<double>(compared),
      duration_text(sum_of(costs).seconds),
      duration_text(sum_of(beside).seconds));
}

void print_json(const std::vector<Case>& cases,
                const std::vector<Cost>& costs,
                const std::vector<Cost>& beside) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    nlohmann::ordered_json entry{{"name", cases[i].info.name},
                                 {"seconds", costs[i].seconds},
                                 {"least_seconds", costs[i].least},
                                 {"most_seconds", costs[i].most},
                                 {"stage_seconds", costs[i].stage_seconds},
                                 {"memory_bytes", costs[i].memory},
                                 {"disk_bytes", costs[i].disk}};
    if (!beside.empty() && !beside[i].stage_seconds.empty()) {
      entry["measured_seconds"] = beside[i].seconds;
      entry["measured_stage_seconds"] = beside[i].stage_seconds;
      entry["measured_memory_bytes"] = beside[i].memory;
      entry["measured_disk_bytes"] = beside[i].disk;
    }
    all.push_back(std::move(entry));
  }
  fmt::print("{}\n", all.dump(1));
}

/// Predicted against measured, a point per case.
Figure scatter(const std::vector<Case>& cases,
               const std::vector<Cost>& costs,
               const std::vector<Cost>& beside) {
  Panel panel{.x_label = "measured seconds",
              .y_label = "predicted seconds",
              .x_log = true,
              .y_log = true};
  std::map<std::string, Series> series;
  double least = 1e9, most = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (beside[i].stage_seconds.empty() || !std::isfinite(costs[i].seconds))
      continue;
    const std::string& name = cases[i].info.experiment;
    Series& own = series[name];
    own.label = own.method = name;
    own.line = false, own.markers = true;
    own.x.push_back(beside[i].seconds);
    own.y.push_back(costs[i].seconds);
    least = std::min(least, beside[i].seconds);
    most = std::max(most, beside[i].seconds);
  }
  for (auto& [name, own] : series) panel.series.push_back(std::move(own));
  for (const double factor : {1 / 1.5, 1.5})
    panel.series.push_back({.label = factor > 1 ? "factor 1.5" : "",
                            .method = "factor",
                            .x = {least, most},
                            .y = {factor * least, factor * most},
                            .dashed = true});
  return {.id = "plan",
          .title = "Time of each case, predicted and measured",
          .panels = {std::move(panel)},
          .columns = 1};
}

/// How long so many workers take, and what share of them works.
void print_workers(const std::vector<Cost>& costs) {
  std::vector<double> seconds;
  for (const Cost& c : known_of(costs)) seconds.push_back(c.seconds);
  if (seconds.empty()) {
    fmt::print(
        "time unknown: no published campaign has these cases; --exact measures "
        "it\n");
    return;
  }
  fmt::print("{:>8}  {:>14}  {:>10}\n", "workers", "time", "efficiency");
  for (const std::size_t workers :
       {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1000}) {
    const Split split = split_longest_first(seconds, workers);
    const double idle =
        static_cast<double>(split.tasks.size()) / static_cast<double>(workers);
    fmt::print("{:>8}  {:>14}  {:>8.1f} %\n",
               workers,
               duration_text(split.longest),
               100 * split.efficiency() * idle);
  }
  fmt::print("the longest case takes {}, a lower bound for the campaign\n",
             duration_text(*std::max_element(seconds.begin(), seconds.end())));
}

/// By short runs of all chains however long that takes, or without runs.
std::vector<Cost> costs_of(const std::vector<Case>& cases, bool exact) {
  if (!exact) return costs_without_runs(cases);
  Trials trials = known_speeds();
  auto costs = predict(cases, trials, [](const Case& c) {
    fmt::print(stderr, "measuring {} {}\n", c.info.experiment, c.info.method);
  });
  trials.save();
  add_memory(costs, cases, Durations::read(durations_file()));
  return costs;
}

}  // namespace

ExitCode plan_verb(const Arguments& arguments) {
  Selection selection;
  std::string beside, plot;
  bool json = false, workers = false, from = false, each = false, exact = false;
  if (!parse(
          "plan",
          "Predicts time, peak memory and disk space of each experiment and in "
          "total. Times of published campaigns are scaled by counted "
          "operations and the speed of this machine. For other methods, times "
          "that --exact measured are read from the user's cache directory.",
          selection.flags(
              {selection.arguments(),
               {"--each", "print a line for each case", &each},
               {"--exact",
                "measure all methods by short runs, without a time limit",
                &exact},
               {"--json", "print each case as JSON", &json},
               {"--against",
                "results of this selection: print measured next to predicted "
                "values",
                &beside,
                "RESULTS"},
               {"--measured",
                "use the times of --against where it has them",
                &from},
               {"--plot",
                "write a plot of predicted against measured times, as SVG",
                &plot,
                "FILE"},
               {"--workers",
                "print time and efficiency of 1 to 1000 workers, longest case "
                "first",
                &workers}}),
          arguments))
    return ExitCode::good;
  if ((from || !plot.empty()) && beside.empty())
    throw UsageError(fmt::format("{} needs --against=RESULTS",
                                 from ? "--measured" : "--plot"));
  const auto cases = selection.cases();
  const auto known =
      beside.empty() ? std::vector<Cost>() : measured(cases, beside);
  const auto costs = from ? known : costs_of(cases, exact);
  if (!plot.empty())
    write_atomically(plot, render_svg(scatter(cases, costs, known)));
  if (workers) {
    print_workers(costs);
  } else if (json) {
    print_json(cases, costs, known);
  } else {
    print_table(lines_of(cases, costs, known, each), !known.empty());
    print_sum(cases, costs);
    print_factors(costs, known);
  }
  return ExitCode::good;
}

}  // namespace physinv
