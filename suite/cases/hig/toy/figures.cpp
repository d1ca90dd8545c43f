#include <fmt/format.h>

#include <cmath>

#include "suite/cases/hig/toy/toy.h"
#include "suite/core/math.h"
#include "suite/evidence/method_table.h"
#include "suite/evidence/quantity.h"
#include "suite/evidence/series.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"

namespace physinv::toy {
namespace {

const std::vector<MethodLine> kLines = {
    {"hig", "HIG", Hue::orange},
    {"gn", "Gauss-Newton", Hue::blue},
    {"gn_tau6", "Gauss-Newton, cut of HIG", Hue::red},
    {"adam", "Adam", Hue::purple},
    {"sgd", "SGD", Hue::green}};
const std::vector<MethodLine> kVariants = {
    {"hig_absolute", "HIG, absolute cut"},
    {"gn_absolute", "Gauss-Newton, absolute cut"},
    {"hig_mean", "HIG, g = r/b"},
    {"gn_mean", "Gauss-Newton, g = r/b"},
    {"hig_sum", "HIG, g = r"},
    {"gn_sum", "Gauss-Newton, g = r"}};

/// Mean and deviation of each neuron of one seed, a panel per method.
Figure neuron_figure(const Evidence& evidence,
                     const std::vector<MethodLine>& lines) {
  Figure figure{.id = "fig1-neurons",
                .title = "Outputs of the hidden neurons over the test points",
                .where = "Fig. 1, middle",
                .columns = 3,
                .note = "Mean and standard deviation (band), one seed."};
  for (const MethodLine& line : lines) {
    const auto run = first_run(evidence, {line.method});
    if (!run) continue;
    const StageRecord& stage = *run->stage;
    const Batch<double>& m = stage.arrays.at("metrics");
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
        s.x.push_back(stage.curve.iteration[static_cast<std::size_t>(i)]);
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

/// (z_1, z_2) of the point from the start to the end, one seed.
Figure path_figure(const Evidence& evidence,
                   const std::vector<MethodLine>& lines) {
  Panel panel{.x_label = "z1", .y_label = "z2", .y_min = -3, .y_max = 3};
  for (const MethodLine& line : lines) {
    const auto run = first_run(evidence, {line.method});
    if (!run) continue;
    const StageRecord& stage = *run->stage;
    const Batch<double>& m = stage.arrays.at("metrics");
    Series s = series_of(line);
    s.markers = true;
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
    panel.series.push_back(mark("target",
                                "truth",
                                math::sin(6 * kPoint),
                                math::cos(9 * kPoint),
                                PlotStyle{Hue::ink, Marker::cross}));
  return {.id = "fig1-path",
          .title = fmt::format("Path of the output at x = {}", kPoint),
          .where = "Fig. 1, right",
          .panels = {panel},
          .columns = 1,
          .note = "One seed; excursions beyond 3 are left out."};
}

Cell saturation(const Evidence& evidence, const Select& runs) {
  Index neurons = 0, saturated = 0;
  for (const Run& run : find_runs(evidence, runs))
    for (const double d : last_deviations(run))
      ++neurons, saturated += is_saturated(d);
  return {.ours = static_cast<double>(saturated),
          .text = fmt::format("{}/{}", saturated, neurons)};
}

Cell saturated_seeds(const Evidence& evidence, const Select& runs) {
  const auto some = count(
      runs, saturated_neurons(), [](double n) { return n > 0; })(evidence);
  return {.ours = some.value.value_or(0),
          .text = fmt::format("{}/{}", some.value.value_or(0), some.runs)};
}

/// Median losses along the way, and what became of the neurons.
Table course_table(const Evidence& evidence,
                   const std::vector<MethodLine>& lines) {
  std::vector<MethodColumn> columns;
  for (const Index e : {1, 5, 20, 96, 200, 400, 4000})
    columns.push_back(median_column(fmt::format("epoch {}", e),
                                    value_after({}, e * kUpdatesPerEpoch)));
  const auto add = [&](const char* head, MetricRow row, Index epochs) {
    columns.push_back(median_column(
        head, value_after(metric(row), epochs * kUpdatesPerEpoch)));
  };
  add("second", kSecondLoss, 20);
  add("beyond", kBeyond, 1);
  add("norm", kWeightNorm, 400);
  columns.push_back({"saturated", saturation});
  columns.push_back({"seeds", saturated_seeds});
  return table_by_method(
      {.id = "course",
       .title = "Median test loss along the way",
       .where = "Fig. 1",
       .digits = 5,
       .corner = "method",
       .note = "Second: loss of the second component after 20 epochs. "
               "Beyond: share of hidden outputs beyond 0.99 after one "
               "epoch. Saturated: neurons whose outputs deviate by less "
               "than 0.02 over the test points at the end, and seeds with "
               "at least one."},
      evidence,
      lines,
      columns);
}

Section report(const Evidence& evidence) {
  const auto all = joined(kLines, kVariants);
  Section section{
      .tables = {loss_table(evidence, all), course_table(evidence, all)},
      .method_titles = titles_of(all)};
  LearningCurves curves(evidence, section);
  curves.losses(kLines, "fig1-loss", "Learning curves", "Fig. 1, left");
  curves.metric(kLines,
                kSecondLoss,
                "loss of the second component",
                "fig1-second",
                "What is learned of the scaled component",
                "Sec. 2.2");
  curves.add(neuron_figure(evidence, kLines));
  curves.add(path_figure(evidence, kLines));
  curves.losses(
      kVariants, "variants", "Absolute cut, other factors of g", "Sec. 2.3");
  return section;
}

}  // namespace

void add_reports(Registry& r) {
  for (const Gamma& gamma : kGammas) r.add_report(gamma.experiment, report);
}

}  // namespace physinv::toy
