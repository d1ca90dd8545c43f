// The solver behind the Kuramoto-Sivashinsky experiment: what accuracy costs,
// how chaos grows with time, and where it breaks.
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "suite/cases/jpo/common/claims.h"
#include "suite/cases/numerics/common/sweep_report.h"
#include "suite/diagnostics/growth.h"
#include "suite/diagnostics/stability_sweep.h"
#include "suite/diagnostics/work_precision.h"
#include "suite/harness/registry.h"

namespace physinv {
namespace {

constexpr const char* kName = "numerics/kuramoto-sivashinsky";
constexpr double kEnd = 25;
constexpr Index kReferenceSteps = 6400;
const std::vector<Index> kSteps = {25, 50, 100, 200, 400, 800, 1600};

ProblemRecipe solver(double end, Index steps) {
  return problem<KuramotoSivashinsky>(
      "kuramoto_sivashinsky",
      {.time_step = end / static_cast<double>(steps), .steps = steps});
}

/// Up to `end` with the experiment's step of 1/4.
ProblemRecipe until(double end) {
  return solver(end, static_cast<Index>(std::lround(4 * end)));
}

std::vector<double> spaced(double first, double step, int count) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(first + step * i);
  return out;
}

std::vector<double> doubled(double first, int count) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(std::ldexp(first, i));
  return out;
}

const SweepAxis kAlpha{"alpha", doubled(0.25, 13), true};
const SweepAxis kBeta{"beta", spaced(-6, 0.5, 25)};
const SweepAxis kLowBeta{"beta", spaced(0, 0.5, 9)};
const SweepAxis kTime{"end time", spaced(5, 9.5, 11)};

// ---- methods --------------------------------------------------------------

std::string stage_name(Index steps) { return fmt::format("steps-{}", steps); }

Method work_precision_method() {
  Method method{"work-precision", {}};
  for (const Index steps : kSteps)
    method.chain.push_back(
        work_precision({.name = stage_name(steps),
                        .problem = solver(kEnd, steps),
                        .reference = solver(kEnd, kReferenceSteps)}));
  return method;
}

Method growth_method() {
  GrowthOptions options;
  for (const double end : spaced(5, 5, 20))
    options.horizons.push_back({end, until(end)});
  return {"growth", {growth(options)}};
}

Method stability_method() {
  StabilitySweepOptions parameters{
      .name = "parameters", .problems = {until(kEnd)}, .examples = 2};
  for (const double beta : kBeta.values)
    for (const double alpha : kAlpha.values)
      parameters.points.push_back({0, Eigen::Vector2d(alpha, beta)});
  StabilitySweepOptions horizons{.name = "horizons", .examples = 2};
  for (const double end : kTime.values) {
    for (const double beta : kLowBeta.values)
      horizons.points.push_back({static_cast<Index>(horizons.problems.size()),
                                 Eigen::Vector2d(1, beta)});
    horizons.problems.push_back(until(end));
  }
  return {"stability",
          {stability_sweep(parameters), stability_sweep(horizons)}};
}

// ---- report ---------------------------------------------------------------

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
    if (p.steps == 0) return Cell{.text = "not run"};
    if (p.error < 0) return Cell{.text = "diverged"};
    return Cell{.ours = p.error, .text = fmt::format("{:.2e}", p.error)};
  };
  const auto time = [](const WorkPoint& p) {
    if (p.seconds <= 0) return Cell{.text = "not run"};
    return Cell{.ours = 1e6 * p.seconds};
  };
  for (const Index steps : kSteps) {
    const WorkPoint fine = at(exact, steps), coarse = at(exact, steps / 2);
    Cell order{.text = "–"};
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

/// Over the samples that have a number: the geometric mean, or nothing.
std::optional<double> typical(const StageRecord& s,
                              const char* array,
                              Index horizon) {
  const auto values = s.arrays.at(array).col(horizon);
  double sum = 0;
  Index count = 0;
  for (const double v : values)
    if (v > 0) sum += std::log(v), ++count;
  if (count == 0) return {};
  return std::exp(sum / static_cast<double>(count));
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
           .text = value ? fmt::format("{:.2e}", *value) : "diverged"});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

ClaimResult second_order(const Results& results) {
  std::optional<double> lowest, highest;
  const auto points = work_points(results, Precision::f64);
  // Longer steps are not yet in the regime of small steps.
  for (std::size_t k = 4; k < points.size(); ++k) {
    if (points[k].error <= 0 || points[k - 1].error <= 0) continue;
    const double order = std::log2(points[k - 1].error / points[k].error);
    lowest = std::min(lowest.value_or(order), order);
    highest = std::max(highest.value_or(order), order);
  }
  Judge judge;
  judge.at_least("lowest order", lowest, 1.8)
      .at_most("highest order", highest, 2.2);
  return std::move(judge).result(
      "N1",
      "The time integration is of second order for steps below 1/8",
      "smoke");
}

ClaimResult chaos(const Results& results) {
  const StageRecord* s = growth_stage(results);
  const auto at = [&](const char* array, double end) -> std::optional<double> {
    if (s == nullptr) return {};
    const auto& time = s->arrays.at("time");
    for (Index k = 0; k < time.cols(); ++k)
      if (time(0, k) == end) return typical(*s, array, k);
    return {};
  };
  const auto early = at("perturbation", kEnd);
  Judge judge;
  judge.above("growth until t = 25", early, 3)
      .above("growth until t = 100", at("perturbation", 100), early)
      .below("float error of u(25)", at("rounding", kEnd), 1e-3)
      .below("float error of the gradient", at("gradient_error", kEnd), 1e-2);
  return std::move(judge).result(
      "N2",
      "Perturbations grow with time, and yet float is good for the experiment: "
      "at t = 25 u is off by less than 1e-3, gradients by less than 1e-2",
      "smoke");
}

Section report(const Results& results, const Published&) {
  const auto* parameters =
      find_sweep(results, kName, "stability", "parameters");
  const auto* horizons = find_sweep(results, kName, "stability", "horizons");
  return {.experiment = kName,
          .title = "Numerics of the Kuramoto-Sivashinsky solver",
          .tables = {work_table(results),
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
                                 horizons)},
          .claims = {second_order(results),
                     chaos(results),
                     adjoint_claim("N3", {parameters, horizons})}};
}

std::vector<Row> rows(Index n) {
  return {{.methods = {"work-precision"},
           .n = {n},
           .seeds = {0},
           .precision = Precision::f64},
          {.methods = {"work-precision"},
           .n = {n},
           .seeds = {0},
           .precision = Precision::f32},
          {.methods = {"growth", "stability"}, .n = {n}, .seeds = {0}}};
}

/// Nothing is learned here.
const Setting kNoNetworks;

const auto kRegistered = register_experiment({
    .name = kName,
    .title = "Numerics of the Kuramoto-Sivashinsky solver",
    .source = {.paper = "jpo", .where = "App. D.3"},
    .problem = until(kEnd),
    .setting = kNoNetworks,
    .profiles = {{.name = "smoke", .rows = rows(4)},
                 {.name = "quick", .rows = rows(8)},
                 {.name = "paper", .rows = rows(32)}},
    .methods = {work_precision_method(), growth_method(), stability_method()},
    .report = report,
});

}  // namespace
}  // namespace physinv
