#include <fmt/format.h>

#include <string>
#include <vector>

#include "suite/cases/numerics/kuramoto_sivashinsky/sweep.h"
#include "suite/diagnostics/work_precision.h"
#include "suite/evidence/cell.h"
#include "suite/harness/registry.h"

namespace physinv::ks_numerics {
namespace {

/// Step sizes that ran: error (mean of the samples) and seconds per sample.
struct WorkPoint {
  Index steps = 0;
  double error = -1, seconds = 0;  ///< -1: some sample diverged
};

std::vector<WorkPoint> work_points(const Results& results,
                                   Precision precision) {
  std::vector<WorkPoint> points;
  for (const CaseRecord& c : results.cases()) {
    if (c.info.experiment != kName || c.info.method != "work-precision" ||
        c.info.precision != precision || !points.empty())
      continue;
    for (const Index steps : kSteps) {
      for (const StageRecord& s : c.stages) {
        if (s.stage != stage_name(steps) || !s.arrays.contains("error"))
          continue;
        const auto& error = s.arrays.at("error");
        points.push_back(
            {steps,
             error.minCoeff() < 0 ? -1 : error.mean(),
             fastest_repetition(s.curve) / static_cast<double>(error.cols())});
      }
    }
  }
  return points;
}

Figure work_figure(const Results& results) {
  Panel panel{.x_label = "seconds per simulation",
              .y_label = "relative error of u(25)",
              .x_log = true,
              .y_log = true};
  for (const auto precision : {Precision::f64, Precision::f32}) {
    Series s{.label = precision == Precision::f64 ? "double" : "float",
             .method = precision == Precision::f64 ? "f64" : "f32",
             .markers = true};
    for (const WorkPoint& p : work_points(results, precision)) {
      if (p.error < 0 || p.seconds <= 0) continue;
      s.x.push_back(p.seconds);
      s.y.push_back(p.error);
    }
    panel.series.push_back(std::move(s));
  }
  return {.id = "work_precision",
          .title = "Accuracy over time, steps of 1 to 1/64",
          .panels = {std::move(panel)},
          .columns = 1,
          .note = fmt::format(
              "Against {} steps in double, mean of the samples; fastest of the "
              "repetitions, all samples in one batch.",
              kReferenceSteps)};
}

Table work_table(const Results& results) {
  Table table{.id = "work_precision",
              .title = "Step size, accuracy and time",
              .digits = 1,
              .corner = "step",
              .columns = {"error, double",
                          "order",
                          "error, float",
                          "us, double",
                          "us, float"},
              .note =
                  "Relative error of u(25); order: log2 of the ratio to the "
                  "step twice as long; us: per simulation."};
  const auto exact = work_points(results, Precision::f64);
  const auto rough = work_points(results, Precision::f32);
  const auto at = [](const std::vector<WorkPoint>& points, Index steps) {
    for (const WorkPoint& p : points)
      if (p.steps == steps) return p;
    return WorkPoint{};
  };
  const auto error = [](const WorkPoint& p) {
    if (p.steps == 0) return Cell{.text = kNotRun};
    if (p.error < 0) return Cell{.text = kDiverged};
    return Cell{.ours = p.error, .text = fmt::format("{:.2e}", p.error)};
  };
  const auto time = [](const WorkPoint& p) {
    if (p.seconds <= 0) return Cell{.text = kNotRun};
    return Cell{.ours = 1e6 * p.seconds};
  };
  for (const Index steps : kSteps) {
    const WorkPoint fine = at(exact, steps), coarse = at(exact, steps / 2);
    Cell order{.text = kNothing};
    if (fine.error > 0 && coarse.error > 0)
      order = {.ours = std::log2(coarse.error / fine.error)};
    table.rows.push_back(
        {fmt::format("{:g}", kEnd / static_cast<double>(steps)),
         {error(fine),
          order,
          error(at(rough, steps)),
          time(fine),
          time(at(rough, steps))}});
  }
  return table;
}

const StageRecord* growth_stage(const Results& results) {
  for (const CaseRecord& c : results.cases())
    if (c.info.experiment == kName && c.info.method == "growth")
      for (const StageRecord& s : c.stages)
        if (s.arrays.contains("perturbation")) return &s;
  return nullptr;
}

Figure growth_figure(const Results& results) {
  Figure figure{.id = "growth",
                .title = "Chaos: growth with the end time",
                .columns = 3,
                .note =
                    "Geometric means of the samples. Perturbations of 1e-8 "
                    "(float: 1e-3) of the initial state; they saturate where "
                    "they become as large as the state."};
  const StageRecord* s = growth_stage(results);
  if (s == nullptr) return figure;
  const auto& time = s->arrays.at("time");
  const auto series =
      [&](const char* label, const char* method, const char* array) {
        Series out{.label = label, .method = method, .markers = true};
        for (Index k = 0; k < time.cols(); ++k) {
          const auto value = typical(*s, array, k);
          if (!value) continue;
          out.x.push_back(time(0, k));
          out.y.push_back(*value);
        }
        return out;
      };
  const auto panel = [](const char* title, std::vector<Series> all) {
    return Panel{.title = title,
                 .x_label = "end time",
                 .y_log = true,
                 .series = std::move(all)};
  };
  figure.panels = {panel("Norm of the loss gradient",
                         {series("double", "f64", "gradient"),
                          series("float", "f32", "gradient_single")}),
                   panel("Growth of a perturbation",
                         {series("double", "f64", "perturbation"),
                          series("float", "f32", "perturbation_single")}),
                   panel("Float against double, relative",
                         {series("state", "state", "rounding"),
                          series("gradient", "gradient", "gradient_error")})};
  return figure;
}

Table growth_table(const Results& results) {
  Table table{.id = "growth",
              .title = "Chaos: growth with the end time",
              .digits = 1,
              .corner = "end time",
              .columns = {"gradient",
                          "perturbation",
                          "perturbation, float",
                          "state, float error",
                          "gradient, float error"},
              .note = "Geometric means of the samples."};
  const StageRecord* s = growth_stage(results);
  if (s == nullptr) return table;
  const auto& time = s->arrays.at("time");
  for (Index k = 0; k < time.cols(); ++k) {
    TableRow row{.label = fmt::format("{:g}", time(0, k))};
    for (const char* array : {"gradient",
                              "perturbation",
                              "perturbation_single",
                              "rounding",
                              "gradient_error"}) {
      const auto value = typical(*s, array, k);
      row.cells.push_back(
          {.ours = value,
           .text = value ? fmt::format("{:.2e}", *value) : kDiverged});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Section report(const Results& results, const Published&) {
  const auto* parameters =
      find_sweep(results, kName, "stability", "parameters");
  const auto* horizons = find_sweep(results, kName, "stability", "horizons");
  return {.tables = {work_table(results),
                     growth_table(results),
                     sweep_table("stability_parameters",
                                 "Stability over alpha and beta, t = 25",
                                 parameters),
                     sweep_table("stability_horizons",
                                 "Stability over beta and end time, alpha = 1",
                                 horizons)},
          .figures = {work_figure(results),
                      growth_figure(results),
                      sweep_maps("stability_parameters",
                                 "Stability over alpha and beta, t = 25",
                                 kAlpha,
                                 kBeta,
                                 parameters),
                      sweep_maps("stability_horizons",
                                 "Stability over beta and end time, alpha = 1",
                                 kLowBeta,
                                 kTime,
                                 horizons)}};
}

const bool kReport = register_report(kName, report);

}  // namespace
}  // namespace physinv::ks_numerics
