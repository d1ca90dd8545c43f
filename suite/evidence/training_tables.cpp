#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "suite/evidence/cell.h"
#include "suite/evidence/curve.h"
#include "suite/evidence/options.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training_report.h"

namespace physinv {
namespace {

/// What updates took, and the bytes that stages hold.
struct UpdateCosts {
  void add(const StageRecord& s, TimedStages& timed) {
    if (const auto all = timed.seconds(s))
      seconds.push_back(*all / std::max(1.0, s.curve.iteration.back()));
    bytes.push_back(static_cast<double>(s.buffer_bytes));
  }

  std::vector<double> seconds, bytes;
};

}  // namespace

Table loss_table(const Results& results,
                 std::string_view experiment,
                 const std::vector<MethodLine>& lines) {
  Table table{.id = "results",
              .title = "Test loss at the end, and what an update takes",
              .digits = 5,
              .corner = "method",
              .columns = {"updates",
                          "median loss",
                          "lowest",
                          "highest",
                          "diverged",
                          "CPU ms / update",
                          "MB"}};
  TimedStages timed;
  for (const MethodLine& line : lines) {
    std::vector<double> losses, updates;
    UpdateCosts costs;
    int diverged = 0;
    for (const auto* s : trained_stages(results, experiment, line.method)) {
      losses.push_back(CurveRow{*s}.last());
      updates.push_back(s->curve.iteration.back());
      costs.add(*s, timed);
      diverged += s->stop == Stop::diverged;
    }
    if (losses.empty()) continue;
    const auto [lowest, highest] =
        std::minmax_element(losses.begin(), losses.end());
    table.rows.push_back(
        {.label = line.label,
         .cells = {written(median(updates)),
                   written(median(losses)),
                   written(*lowest),
                   written(*highest),
                   Cell{.ours = diverged,
                        .text = fmt::format("{}/{}", diverged, losses.size())},
                   costs.seconds.empty() ? Cell{.text = kCrowded}
                                         : written(1e3 * median(costs.seconds)),
                   written(1e-6 * median(costs.bytes))}});
  }
  table.note = "Memory: buffers the stage holds. " + timed.note();
  return table;
}

namespace {

/// The curve with this label, a new one at the end if there is none.
Series& curve_of(const std::string& label,
                 const MethodLine& line,
                 std::vector<Series>& curves) {
  const auto known =
      std::find_if(curves.begin(), curves.end(), [&](const Series& s) {
        return s.label == label;
      });
  if (known != curves.end()) return *known;
  return curves.emplace_back(Series{
      .label = label, .method = label, .markers = true, .look = look_of(line)});
}

/// Ascending in x.
void sort_points(Series& series) {
  std::vector<std::pair<double, double>> points;
  for (std::size_t k = 0; k < series.x.size(); ++k)
    points.emplace_back(series.x[k], series.y[k]);
  std::sort(points.begin(), points.end());
  for (std::size_t k = 0; k < points.size(); ++k)
    std::tie(series.x[k], series.y[k]) = points[k];
}

}  // namespace

Figure update_times(const Results& results,
                    std::string_view experiment,
                    const std::vector<MethodLine>& lines,
                    std::string source) {
  Panel panel{.x_label = "batch size",
              .y_label = "CPU ms of an update",
              .x_log = true,
              .y_log = true};
  TimedStages timed;
  for (const MethodLine& line : lines) {
    const auto stages = trained_stages(results, experiment, line.method);
    UpdateCosts costs;
    for (const auto* s : stages) costs.add(*s, timed);
    const auto batch = stages.empty()
                           ? std::nullopt
                           : number_of(stages.front()->options, "batch");
    if (!batch || costs.seconds.empty()) continue;
    Series& curve = curve_of(
        line.label.substr(0, line.label.find(',')), line, panel.series);
    // The first line of a batch size is the one that was run longest.
    if (std::find(curve.x.begin(), curve.x.end(), *batch) != curve.x.end())
      continue;
    curve.x.push_back(*batch);
    curve.y.push_back(1e3 * median(costs.seconds));
  }
  for (Series& curve : panel.series) sort_points(curve);
  return {.id = "update_times",
          .title = "What an update takes",
          .source = std::move(source),
          .panels = {std::move(panel)},
          .columns = 1,
          .note = timed.note()};
}

std::optional<Answered> first_answer(const Results& results,
                                     std::string_view experiment,
                                     std::string_view method) {
  const auto chains = trained_chains(results, experiment, method);
  if (chains.empty()) return {};
  const CaseRecord& c = *chains.front();
  const Batch<double>& x = c.stages.back().x;
  if (x.cols() == 0 || c.data.y.cols() == 0 || !x.col(0).allFinite()) return {};
  const auto first = [](const Batch<double>& all) {
    return all.size() > 0 ? Vector<double>(all.col(0)) : Vector<double>();
  };
  return Answered{
      first(c.data.given), first(c.data.y), first(c.data.x), first(x)};
}

Figure answered_fields(
    const Results& results,
    std::string_view experiment,
    const std::vector<MethodLine>& lines,
    std::string source,
    const std::function<Panel(std::string, const Vector<double>&)>& picture) {
  Figure figure{.id = "fields",
                .title = "What was there, what is seen, what is found",
                .source = std::move(source),
                .columns = 3,
                .note = "First test example."};
  for (const MethodLine& line : lines) {
    const auto answer = first_answer(results, experiment, line.method);
    if (!answer) continue;
    if (figure.panels.empty())
      figure.panels = {picture("truth x*", answer->truth),
                       picture("observed y", answer->wanted)};
    figure.panels.push_back(picture(line.label, answer->x));
  }
  return figure;
}

Table cost_table(const Results& results,
                 std::string_view experiment,
                 const Published& published,
                 const std::vector<CostLine>& lines,
                 std::string source) {
  Table table{.id = "cost",
              .title = "Memory and duration of an update",
              .source = std::move(source),
              .digits = 2,
              .corner = "method",
              .columns = {"MB", "CPU ms / update"}};
  TimedStages timed;
  for (const CostLine& line : lines) {
    UpdateCosts costs;
    for (const auto* s : trained_stages(results, experiment, line.method))
      costs.add(*s, timed);
    Cell megabytes, duration;
    if (const auto v = published.find(experiment, line.published + "/memory"))
      megabytes.paper = v->value;
    if (const auto v = paper_update(published, experiment, line.published))
      duration.paper = 1e3 * *v;
    if (costs.bytes.empty()) {
      megabytes.text = duration.text = kNotRun;
    } else {
      megabytes.ours = 1e-6 * median(costs.bytes);
      if (costs.seconds.empty())
        duration.text = kCrowded;
      else
        duration.ours = 1e3 * median(costs.seconds);
    }
    table.rows.push_back({.label = line.label, .cells = {megabytes, duration}});
  }
  table.note =
      "Ours: bytes of the buffers the stage holds, median over seeds. " +
      timed.note() + " The paper's machine had a GPU.";
  return table;
}

}  // namespace physinv
