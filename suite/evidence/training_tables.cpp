#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "suite/evidence/cell.h"
#include "suite/evidence/curve.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training_report.h"

namespace physinv {
namespace {

/// What updates took, and the bytes that stages hold.
struct Costs {
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
    Costs costs;
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
    Costs costs;
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
