#include "suite/cases/hig/toy/figures.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "suite/cases/jpo/common/endings.h"
#include "suite/evidence/curve.h"

namespace physinv::toy {
namespace {

constexpr double kSaturated = 0.02;
constexpr Index kUpdatesPerEpoch = 4;

/// The row of a stage's metrics at the last point at or before `updates`.
std::optional<double> metric(const StageRecord& stage,
                             Index row,
                             Index updates) {
  if (!stage.arrays.contains("metrics")) return {};
  const auto k = last_point(stage, updates);
  if (!k) return {};
  return stage.arrays.at("metrics")(row, *k);
}

/// The first seed that a method was run with.
const StageRecord* first_seed(const Results& results,
                              std::string_view experiment,
                              std::string_view method) {
  for (const auto* stage : trained_stages(results, experiment, method))
    if (stage->arrays.contains("metrics")) return stage;
  return nullptr;
}

Cell number(std::optional<double> value) {
  if (!value) return {.text = "not run"};
  if (!std::isfinite(*value)) return {.text = "not finite"};
  return {.text = fmt::format("{:.3g}", *value)};
}

}  // namespace

std::optional<double> median_metric(const Results& results,
                                    std::string_view experiment,
                                    std::string_view method,
                                    MetricRow row,
                                    Index updates) {
  std::vector<double> values;
  for (const auto* stage : trained_stages(results, experiment, method))
    if (const auto v = metric(*stage, row, updates)) values.push_back(*v);
  if (values.empty()) return {};
  return median(values);
}

std::optional<Saturation> saturation(const Results& results,
                                     std::string_view experiment,
                                     std::string_view method) {
  Saturation all;
  for (const auto* stage : trained_stages(results, experiment, method)) {
    if (!stage->arrays.contains("metrics")) continue;
    const auto end = stage->arrays.at("metrics").rightCols(1);
    const auto flat = static_cast<int>(
        (end.middleRows(kDeviations, kHidden).array() < kSaturated).count());
    all.neurons += kHidden, all.saturated += flat;
    ++all.seeds, all.seeds_with_one += flat > 0;
  }
  if (all.seeds == 0) return {};
  return all;
}

Figure neuron_figure(const Results& results,
                     std::string_view experiment,
                     const std::vector<MethodLine>& lines) {
  Figure figure{.id = "fig1-neurons",
                .title = "Outputs of the hidden neurons over the test points",
                .source = "Fig. 1, middle",
                .columns = 3,
                .note = "Mean and standard deviation (band), one seed."};
  for (const MethodLine& line : lines) {
    const auto* stage = first_seed(results, experiment, line.method);
    if (stage == nullptr) continue;
    const Batch<double>& m = stage->arrays.at("metrics");
    Panel panel{.title = line.label,
                .x_label = "updates",
                .y_label = "hidden output",
                .x_log = true,
                .y_min = -1.5,
                .y_max = 1.5};
    for (Index k = 0; k < kHidden; ++k) {
      const std::string name = fmt::format("neuron {}", k + 1);
      Series s{.label = name, .method = name};
      // A logarithmic axis has no place for the start.
      for (Index i = 1; i < m.cols(); ++i) {
        const double mean = m(kMeans + k, i), spread = m(kDeviations + k, i);
        s.x.push_back(stage->curve.iteration[static_cast<std::size_t>(i)]);
        s.y.push_back(mean);
        s.lo.push_back(mean - spread);
        s.hi.push_back(mean + spread);
      }
      panel.series.push_back(std::move(s));
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Figure path_figure(const Results& results,
                   std::string_view experiment,
                   const std::vector<MethodLine>& lines) {
  Panel panel{.x_label = "z1", .y_label = "z2", .y_min = -3, .y_max = 3};
  for (const MethodLine& line : lines) {
    const auto* stage = first_seed(results, experiment, line.method);
    if (stage == nullptr) continue;
    const Batch<double>& m = stage->arrays.at("metrics");
    Series s{.label = line.label, .method = line.colour, .markers = true};
    // An excursion beyond the frame would hide everything else.
    for (Index i = 0; i < m.cols(); ++i) {
      if (std::abs(m(kPathFirst, i)) > 3 || std::abs(m(kPathSecond, i)) > 3)
        continue;
      s.x.push_back(m(kPathFirst, i));
      s.y.push_back(m(kPathSecond, i));
    }
    panel.series.push_back(std::move(s));
  }
  if (!panel.series.empty())
    panel.series.push_back({.label = "target",
                            .method = "truth",
                            .x = {std::sin(6 * kPoint)},
                            .y = {std::cos(9 * kPoint)},
                            .line = false,
                            .markers = true});
  return {.id = "fig1-path",
          .title = fmt::format("Path of the output at x = {}", kPoint),
          .source = "Fig. 1, right",
          .panels = {panel},
          .columns = 1,
          .note = "One seed; excursions beyond 3 are left out."};
}

Table course_table(const Results& results,
                   std::string_view experiment,
                   const std::vector<MethodLine>& lines) {
  constexpr std::array<Index, 7> kEpochs = {1, 5, 20, 96, 200, 400, 4000};
  Table table{.id = "course",
              .title = "Median test loss along the way",
              .source = "Fig. 1",
              .digits = 5,
              .corner = "method",
              .note =
                  "Second: loss of the second component after 20 epochs. "
                  "Beyond: share of hidden outputs beyond 0.99 after one "
                  "epoch. Saturated: neurons whose outputs deviate by less "
                  "than 0.02 over the test points at the end, and seeds with "
                  "at least one."};
  for (const Index e : kEpochs)
    table.columns.push_back(fmt::format("epoch {}", e));
  for (const char* more : {"second", "beyond", "norm", "saturated", "seeds"})
    table.columns.push_back(more);
  for (const MethodLine& line : lines) {
    const auto flat = saturation(results, experiment, line.method);
    if (!flat) continue;
    TableRow row{.label = line.label};
    for (const Index e : kEpochs)
      row.cells.push_back(number(median_test_loss(
          results, experiment, line.method, e * kUpdatesPerEpoch)));
    const auto at = [&](MetricRow which, Index epoch) {
      row.cells.push_back(number(median_metric(
          results, experiment, line.method, which, epoch * kUpdatesPerEpoch)));
    };
    at(kSecondLoss, 20), at(kBeyond, 1), at(kWeightNorm, 400);
    row.cells.push_back(
        {.text = fmt::format("{}/{}", flat->saturated, flat->neurons)});
    row.cells.push_back(
        {.text = fmt::format("{}/{}", flat->seeds_with_one, flat->seeds)});
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace physinv::toy
