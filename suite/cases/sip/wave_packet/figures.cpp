// Fig. 16 of the SIP paper: two examples with their fits, and learning curves.
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "suite/cases/sip/wave_packet/values.h"
#include "suite/core/math.h"
#include "suite/evidence/method_table.h"
#include "suite/evidence/quantity.h"
#include "suite/evidence/series.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"
#include "suite/store/record.h"

namespace physinv::sip_wave_packet {
namespace {

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
  Series s = series_of(line);
  s.x = axis(samples);
  for (const double t : s.x) {
    const double d = t - kStart - x;
    s.y.push_back(math::sin(kFrequency * d) * math::exp(-d * d / 800));
  }
  return s;
}

/// Example i of the first seed: the data and what the methods make of it.
Panel example(const Evidence& e, Index i) {
  Panel panel{.x_label = "t", .y_label = "signal"};
  for (const MethodLine& line : {kLines[0], kLines[1]}) {
    const auto run = first_run(e, {line.method});
    if (!run || run->stage->x.cols() <= i) continue;
    const CaseData& data = run->record->data;
    const Index samples = data.y.rows();
    if (panel.series.empty()) {
      panel.title = fmt::format("t0 = {:.1f}", kStart + data.x(0, i));
      panel.series.push_back({.label = "data",
                              .method = "data",
                              .x = axis(samples),
                              .y = {data.y.col(i).begin(), data.y.col(i).end()},
                              .style = PlotStyle{.hue = Hue::ink}});
    }
    panel.series.push_back(packet(line, run->stage->x(0, i), samples));
    panel.series.back().dashed = panel.series.size() > 2;
  }
  return panel;
}

/// Horizontal lines of what does not learn, as long as the curve is.
void add_levels(const Evidence& e, const RunRow& row, Panel& panel) {
  if (panel.series.empty() || panel.series.front().x.empty()) return;
  const auto& x = panel.series.front().x;
  const double first = x.front(), last = x.back();
  for (const MethodLine& line : {kLines[1], kLines[2]}) {
    const auto value = median({line.method}, of_row(row, mean_of))(e).value;
    if (!value) continue;
    panel.series.push_back(
        level(line.label, line.method, first, last, *value, style_of(line)));
  }
}

MethodColumn share(std::string head,
                   RunRow row,
                   std::function<bool(double)> test) {
  return quantity_column(std::move(head), [=](const Select& who) {
    return share_of_examples(who, row, test);
  });
}

RunValue quantile_of(RunRow row, double q) {
  return [=](const Run& run) -> std::optional<double> {
    auto values = row(run);
    if (values.empty()) return {};
    return quantile(std::move(values), q);
  };
}

Table at_the_end(const Evidence& e) {
  return table_by_method(
      {.id = "results",
       .title = "At the end, medians over seeds",
       .digits = 3,
       .corner = "method",
       .note = "Losses and their quantiles over the examples, errors "
               "|t0 - t0*| in samples, shares. Equal to L-BFGS-B's: within a "
               "millionth."},
      e,
      kLines,
      {median_column("mean loss", of_row(losses(), mean_of)),
       median_column("10 %", quantile_of(losses(), 0.1)),
       median_column("50 %", quantile_of(losses(), 0.5)),
       median_column("90 %", quantile_of(losses(), 0.9)),
       median_column("mean error", of_row(errors(), mean_of)),
       median_column("median error", quantile_of(errors(), 0.5)),
       share("within 2", errors(), [](double v) { return v < 2; }),
       share("within half a period",
             errors(),
             [](double v) { return v <= kBasin; }),
       share("loss below L-BFGS-B's",
             loss_over_lbfgs(),
             [](double v) { return v < -1e-6; }),
       share("equal", loss_over_lbfgs(), [](double v) {
         return std::abs(v) <= 1e-6;
       })});
}

Table by_distance(const Evidence& e) {
  constexpr double kEdges[] = {0, 2, 6, 15, 40};
  std::vector<MethodColumn> columns;
  for (std::size_t k = 0; k < std::size(kEdges); ++k) {
    const bool last = k + 1 == std::size(kEdges);
    columns.push_back(
        share(last ? fmt::format("beyond {}", kEdges[k])
                   : fmt::format("{} to {}", kEdges[k], kEdges[k + 1]),
              errors(kEdges[k], last ? kInfinite : kEdges[k + 1]),
              [](double v) { return v < 2; }));
  }
  return table_by_method(
      {.id = "distance",
       .title = "Share of packets found, by distance from the start",
       .digits = 3,
       .corner = "method",
       .note = "Found: |t0 - t0*| < 2. The start is t0 = 76.8."},
      e,
      kLines,
      columns);
}

Section report(const Evidence& e) {
  Section section{.tables = {at_the_end(e), by_distance(e)},
                  .method_titles = titles_of(kLines)};
  LearningCurves curves(e, section);
  curves.add({.id = "fig16a",
              .title = "Two examples and their fits",
              .where = "Fig. 16a",
              .panels = {example(e, 0), example(e, 1)},
              .columns = 1,
              .note = "Of the first seed, at the end.",
              .picture = true});
  Panel loss = curves.panel({kNetLine});
  add_levels(e, losses(), loss);
  curves.add({.id = "fig16b",
              .title = "Learning curves: the objective",
              .where = "Fig. 16b",
              .panels = {std::move(loss)},
              .columns = 1,
              .note = "Median over seeds, band: 10 % and 90 % quantiles; "
                      "dashed: what does not "
                      "learn, on the same examples."});
  curves.metric({kNetLine},
                kMeanError,
                "mean |t0 - t0*|",
                "fig16b-error",
                "Learning curves: distance from the true position",
                "Fig. 16b");
  for (Figure& f : section.figures)
    if (f.id == "fig16b-error") add_levels(e, errors(), f.panels.front());
  curves.metric({kNetLine},
                kInBasin,
                "share within half a period",
                "basin",
                "Packets localized",
                "");
  return section;
}

}  // namespace

void add_reports(Registry& r) { r.add_report("sip/wave-packet", report); }

}  // namespace physinv::sip_wave_packet
