// Fig. 16 of the SIP paper: two examples with their fits, and learning curves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "suite/cases/sip/wave_packet/values.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/quantity.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"
#include "suite/results/record.h"

namespace physinv::sip_wave_packet {
namespace {

constexpr const char* kName = "sip/wave-packet";
constexpr double kStart = 76.8;
const MethodLine kNetLine{"net", "network", Hue::blue};
const std::vector<MethodLine> kLines = {kNetLine,
                                        {"lbfgs", "L-BFGS-B", Hue::orange},
                                        {"random", "random", Hue::grey}};

std::vector<double> axis(Index samples) {
  std::vector<double> t;
  for (Index i = 0; i < samples; ++i) t.push_back(static_cast<double>(i + 1));
  return t;
}

/// The packet at t0 less the start.
Series packet(const MethodLine& line, double x, Index samples) {
  Series s{.label = line.label,
           .method = line.method,
           .x = axis(samples),
           .look = look_of(line)};
  for (const double t : s.x) {
    const double d = t - kStart - x;
    s.y.push_back(std::sin(kFrequency * d) * std::exp(-d * d / 800));
  }
  return s;
}

/// Example i of the first seed: the data and what the methods make of it.
Panel example(const Evidence& e, Index i) {
  Panel panel{.x_label = "t", .y_label = "signal"};
  for (const MethodLine& line : {kLines[0], kLines[1]}) {
    const auto runs = find_runs(e, {line.method});
    if (runs.empty() || runs.front().stage->x.cols() <= i) continue;
    const CaseData& data = runs.front().record->data;
    const Index samples = data.y.rows();
    if (panel.series.empty()) {
      panel.title = fmt::format("t0 = {:.1f}", kStart + data.x(0, i));
      panel.series.push_back({.label = "data",
                              .method = "data",
                              .x = axis(samples),
                              .y = {data.y.col(i).begin(), data.y.col(i).end()},
                              .look = Look{.hue = Hue::ink}});
    }
    panel.series.push_back(packet(line, runs.front().stage->x(0, i), samples));
    panel.series.back().dashed = panel.series.size() > 2;
  }
  return panel;
}

/// A horizontal line as long as the panel's curves.
Series level(const MethodLine& line, double value, const Panel& panel) {
  Series s{.label = line.label,
           .method = line.method,
           .dashed = true,
           .look = look_of(line)};
  for (const Series& other : panel.series)
    if (!other.x.empty()) s.x = {other.x.front(), other.x.back()};
  s.y.assign(s.x.size(), value);
  return s;
}

/// Horizontal lines of what does not learn.
void add_levels(const Evidence& e, const RunRow& row, Panel& panel) {
  if (panel.series.empty()) return;
  const Panel learned = panel;
  for (const MethodLine& line : {kLines[1], kLines[2]}) {
    const Measured value = median({line.method}, mean_of(row))(e);
    if (value.value) panel.series.push_back(level(line, *value.value, learned));
  }
}

Table results_table(const Evidence& e) {
  Table table{
      .id = "results",
      .title = "At the end, medians over seeds",
      .digits = 3,
      .corner = "method",
      .columns = {"mean loss",
                  "10 %",
                  "50 %",
                  "90 %",
                  "mean error",
                  "median error",
                  "within 2",
                  "within half a period",
                  "better than L-BFGS-B",
                  "equal",
                  "worse"},
      .note =
          "Losses of all examples, errors |t0 - t0*| in samples, shares. "
          "Equal: losses that differ by less than a millionth."};
  for (const MethodLine& line : kLines) {
    const Select who{line.method};
    const auto quantile_of = [](RunRow row, double q) {
      return [=](const Run& run) -> std::optional<double> {
        auto values = row(run);
        if (values.empty()) return {};
        return quantile(values, q);
      };
    };
    const auto share = [&](RunRow row, auto test) {
      return written(share_of_examples(who, row, test)(e));
    };
    if (find_runs(e, who).empty()) continue;
    TableRow row{.label = line.label};
    row.cells.push_back(written(median(who, mean_of(losses()))(e)));
    for (const double q : {0.1, 0.5, 0.9})
      row.cells.push_back(written(median(who, quantile_of(losses(), q))(e)));
    row.cells.push_back(written(median(who, mean_of(errors()))(e)));
    row.cells.push_back(written(median(who, quantile_of(errors(), 0.5))(e)));
    row.cells.push_back(share(errors(), [](double v) { return v < 2; }));
    row.cells.push_back(share(errors(), [](double v) { return v <= kBasin; }));
    const bool compares = line.method != "lbfgs";
    const auto beside = [&](auto test) {
      return compares ? share(loss_over_lbfgs(), test)
                      : written({}, "", kNothing);
    };
    row.cells.push_back(beside([](double v) { return v <= -1e-6; }));
    row.cells.push_back(beside([](double v) { return std::abs(v) < 1e-6; }));
    row.cells.push_back(beside([](double v) { return v >= 1e-6; }));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table by_distance(const Evidence& e) {
  constexpr double kEdges[] = {0, 2, 6, 15, 40, 1e9};
  Table table{.id = "distance",
              .title = "Share of packets found, by distance from the start",
              .digits = 3,
              .corner = "method",
              .note = "Found: |t0 - t0*| < 2. The start is t0 = 76.8."};
  for (std::size_t k = 0; k + 1 < std::size(kEdges); ++k)
    table.columns.push_back(
        kEdges[k + 1] < 1e9 ? fmt::format("{} to {}", kEdges[k], kEdges[k + 1])
                            : fmt::format("beyond {}", kEdges[k]));
  for (const MethodLine& line : kLines) {
    if (find_runs(e, {line.method}).empty()) continue;
    TableRow row{.label = line.label};
    for (std::size_t k = 0; k + 1 < std::size(kEdges); ++k)
      row.cells.push_back(written(share_of_examples(
          {line.method}, errors(kEdges[k], kEdges[k + 1]), [](double v) {
            return v < 2;
          })(e)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Section report(const Results& results, const Published& published) {
  const Evidence e{results, published, kName};
  Section section{.experiment = kName,
                  .tables = {results_table(e), by_distance(e)}};
  LearningCurves curves(results, section);
  curves.add({.id = "fig16a",
              .title = "Two examples and their fits",
              .source = "Fig. 16a",
              .panels = {example(e, 0), example(e, 1)},
              .columns = 1,
              .note = "Of the first seed, at the end."});
  Panel loss = curves.panel({kNetLine});
  add_levels(e, losses(), loss);
  curves.add({.id = "fig16b",
              .title = "Learning curves: the objective",
              .source = "Fig. 16b",
              .panels = {std::move(loss)},
              .columns = 1,
              .note = "Median over seeds, band: range; dashed: what does not "
                      "learn, on the same examples."});
  curves.metric({kNetLine},
                kMeanError,
                "mean |t0 - t0*|",
                "fig16b-error",
                "Learning curves: distance from the true position",
                "Fig. 16b");
  if (section.figures.size() > 2)
    add_levels(e, errors(), section.figures.back().panels.front());
  curves.metric({kNetLine},
                kInBasin,
                "share within half a period",
                "basin",
                "Packets localized",
                "");
  return section;
}

const bool kReport = register_report(kName, report);

}  // namespace
}  // namespace physinv::sip_wave_packet
