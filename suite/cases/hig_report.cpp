#include "suite/cases/hig_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "suite/cases/jpo_endings.h"

namespace physinv {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::vector<const StageRecord*> stages_of(const Results& results,
                                          std::string_view experiment,
                                          std::string_view method) {
  std::vector<const StageRecord*> found;
  for (const std::uint64_t seed : results.seeds(experiment))
    if (const auto* s = trained_stage(results, experiment, method, seed))
      found.push_back(s);
  return found;
}

/// Mean test loss at point k; what overflowed is infinite again.
double at(const StageRecord& s, std::size_t k) {
  const double loss = s.arrays.at("mean_loss")(0, static_cast<Index>(k));
  return loss < std::numeric_limits<double>::max() ? loss : kInfinite;
}

/// Median and range over the stages at each point that all of them have.
Series median_series(const std::vector<const StageRecord*>& stages,
                     const MethodLine& line,
                     std::vector<double> Curve::*axis) {
  Series s{.label = line.label, .method = line.colour};
  std::size_t points = stages.empty() ? 0 : SIZE_MAX;
  for (const auto* stage : stages)
    points = std::min(points, stage->curve.iteration.size());
  for (std::size_t k = 0; k < points; ++k) {
    std::vector<double> losses, x;
    for (const auto* stage : stages) {
      losses.push_back(at(*stage, k));
      x.push_back((stage->curve.*axis)[k]);
    }
    const double middle = median(losses);
    // Logarithmic axes have no place for the start, nor for the end of time.
    if (median(x) <= 0 || !std::isfinite(middle)) continue;
    s.x.push_back(median(x));
    s.y.push_back(middle);
    const auto [lo, hi] = std::minmax_element(losses.begin(), losses.end());
    s.lo.push_back(*lo);
    s.hi.push_back(std::isfinite(*hi) ? *hi : middle);
  }
  return s;
}

}  // namespace

const StageRecord* trained_stage(const Results& results,
                                 std::string_view experiment,
                                 std::string_view method,
                                 std::uint64_t seed) {
  for (const Index n : results.sizes(experiment)) {
    const CaseRecord* c = results.find_case(experiment, method, n, seed);
    if (c == nullptr || c->stages.size() != c->info.stages.size()) continue;
    const StageRecord& last = c->stages.back();
    if (last.arrays.contains("mean_loss")) return &last;
  }
  return nullptr;
}

std::optional<double> test_loss(const StageRecord* stage, Index updates) {
  if (stage == nullptr) return {};
  const auto& iteration = stage->curve.iteration;
  const bool diverged = stage->stop == Stop::diverged;
  if (iteration.back() < static_cast<double>(updates))
    return diverged ? std::optional(kInfinite) : std::nullopt;
  const auto after = std::upper_bound(
      iteration.begin(), iteration.end(), static_cast<double>(updates));
  return at(*stage, static_cast<std::size_t>(after - iteration.begin()) - 1);
}

std::optional<double> median_test_loss(const Results& results,
                                       std::string_view experiment,
                                       std::string_view method,
                                       Index updates) {
  std::vector<double> losses;
  for (const auto* s : stages_of(results, experiment, method))
    if (const auto loss = test_loss(s, updates)) losses.push_back(*loss);
  if (losses.empty()) return {};
  return median(losses);
}

Figure loss_figure(const Results& results,
                   std::string_view experiment,
                   const std::vector<MethodLine>& lines,
                   std::string id,
                   std::string title,
                   std::string source) {
  Panel updates{.x_label = "updates",
                .y_label = "test loss",
                .x_log = true,
                .y_log = true};
  Panel seconds = updates;
  seconds.x_label = "seconds";
  for (const MethodLine& line : lines) {
    const auto stages = stages_of(results, experiment, line.method);
    if (stages.empty()) continue;
    updates.series.push_back(median_series(stages, line, &Curve::iteration));
    seconds.series.push_back(median_series(stages, line, &Curve::seconds));
  }
  return {.id = std::move(id),
          .title = std::move(title),
          .source = std::move(source),
          .panels = {updates, seconds},
          .note =
              "Median over seeds, band: range. Test losses are not finite "
              "where a line ends early."};
}

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
                          "ms / update",
                          "MB"},
              .note =
                  "Memory: buffers the stage holds. Times on this machine, "
                  "one thread per case."};
  for (const MethodLine& line : lines) {
    std::vector<double> losses, seconds, updates, bytes;
    int diverged = 0;
    for (const auto* s : stages_of(results, experiment, line.method)) {
      losses.push_back(at(*s, s->curve.iteration.size() - 1));
      updates.push_back(s->curve.iteration.back());
      seconds.push_back(s->clocks.solve.wall /
                        std::max(1.0, s->curve.iteration.back()));
      bytes.push_back(static_cast<double>(s->buffer_bytes));
      diverged += s->stop == Stop::diverged;
    }
    TableRow row{.label = line.label};
    if (losses.empty()) {
      row.cells.assign(table.columns.size(), Cell{.text = "not run"});
    } else {
      const auto number = [](double v) {
        return Cell{.text = std::isfinite(v) ? fmt::format("{:.3g}", v)
                                             : "not finite"};
      };
      row.cells = {number(median(updates)),
                   number(median(losses)),
                   number(*std::min_element(losses.begin(), losses.end())),
                   number(*std::max_element(losses.begin(), losses.end())),
                   Cell{.text = fmt::format("{}/{}", diverged, losses.size())},
                   number(1e3 * median(seconds)),
                   number(1e-6 * median(bytes))};
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace physinv
