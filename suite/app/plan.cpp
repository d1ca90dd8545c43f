#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "reports/plot.h"
#include "suite/app/load.h"
#include "suite/app/options.h"
#include "suite/app/speeds.h"
#include "suite/harness/progress.h"
#include "suite/planning/predict.h"
#include "suite/planning/split.h"
#include "suite/results/curves.h"
#include "suite/results/file.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

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

struct Sum {
  double seconds = 0, memory = 0, disk = 0;
};

Sum sum_of(const std::vector<Cost>& costs) {
  Sum sum;
  for (const Cost& c : costs) {
    sum.seconds += c.seconds;
    sum.memory = std::max(sum.memory, c.memory);
    sum.disk += c.disk;
  }
  return sum;
}

void print_table(const std::vector<Case>& cases,
                 const std::vector<Cost>& costs,
                 const std::vector<Cost>& beside) {
  std::size_t width = 4;
  for (const Case& c : cases) width = std::max(width, c.info.name.size());
  fmt::print("{:<{}}  {:>10}  {:>9}  {:>9}{}\n",
             "case",
             width,
             "time",
             "memory",
             "disk",
             beside.empty() ? "" : "   measured  factor");
  std::size_t compared = 0, close = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Cost& c = costs[i];
    std::string more;
    if (!beside.empty() && !beside[i].stage_seconds.empty()) {
      const double factor = c.seconds / beside[i].seconds;
      ++compared;
      if (factor <= 1.5 && factor >= 1 / 1.5) ++close;
      more = fmt::format(
          "  {:>9}  {:>6.2f}", duration_text(beside[i].seconds), factor);
    }
    fmt::print("{:<{}}  {:>10}  {:>9}  {:>9}{}\n",
               cases[i].info.name,
               width,
               duration_text(c.seconds),
               bytes_text(c.memory),
               bytes_text(c.disk),
               more);
  }
  const Sum sum = sum_of(costs);
  fmt::print("{} cases: {} of one core, {} on disk, at most {} per worker\n",
             cases.size(),
             duration_text(sum.seconds),
             bytes_text(sum.disk),
             bytes_text(sum.memory));
  if (compared > 0)
    fmt::print(
        "{} of {} cases within a factor 1.5 of what was measured ({:.0f} %); "
        "in "
        "sum {} predicted, {} measured\n",
        close,
        compared,
        100.0 * static_cast<double>(close) / static_cast<double>(compared),
        duration_text(sum.seconds),
        duration_text(sum_of(beside).seconds));
}

void print_json(const std::vector<Case>& cases,
                const std::vector<Cost>& costs,
                const std::vector<Cost>& beside) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    nlohmann::ordered_json entry{{"name", cases[i].info.name},
                                 {"seconds", costs[i].seconds},
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
    if (beside[i].stage_seconds.empty()) continue;
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
  for (const Cost& c : costs) seconds.push_back(c.seconds);
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
  fmt::print("the longest case takes {}, which bounds the campaign\n",
             duration_text(*std::max_element(seconds.begin(), seconds.end())));
}

}  // namespace

ExitCode plan_verb(const Arguments& arguments) {
  Selection selection;
  std::string beside, plot;
  bool json = false, workers = false, from = false;
  if (!parse("plan",
             "What a selection will cost: time, peak memory and disk of each "
             "case and in sum, from counted operations and the speeds of this "
             "machine, which short runs measure once and the user's cache "
             "directory keeps.",
             selection.flags(
                 {{"--json", "as JSON", &json},
                  {"--against",
                   "results of this selection: shows what was measured beside "
                   "what is predicted",
                   &beside,
                   "RESULTS"},
                  {"--measured",
                   "take the times of --against themselves, where it has them",
                   &from},
                  {"--plot",
                   "draw predicted against measured times there, as SVG",
                   &plot,
                   "FILE"},
                  {"--workers",
                   "time and efficiency of 1 to 1000 workers, longest case "
                   "first",
                   &workers}}),
             arguments))
    return ExitCode::good;
  if ((from || !plot.empty()) && beside.empty())
    throw UsageError(fmt::format("{} needs results; --against names them",
                                 from ? "--measured" : "--plot"));
  const auto cases = selection.cases();
  const auto known =
      beside.empty() ? std::vector<Cost>() : measured(cases, beside);
  Trials trials = known_speeds();
  auto costs = from ? known : predict(cases, trials, [](const Case& c) {
    fmt::print(stderr, "measuring {} {}\n", c.info.experiment, c.info.method);
  });
  trials.save();
  if (!plot.empty())
    write_atomically(plot, render_svg(scatter(cases, costs, known)));
  if (workers) {
    print_workers(costs);
  } else {
    json ? print_json(cases, costs, known) : print_table(cases, costs, known);
  }
  return ExitCode::good;
}

}  // namespace physinv
