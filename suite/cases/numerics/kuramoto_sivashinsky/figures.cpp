#include <fmt/format.h>

#include <vector>

#include "suite/cases/numerics/kuramoto_sivashinsky/sweep.h"
#include "suite/evidence/cell.h"
#include "suite/harness/registry.h"

namespace physinv::ks_numerics {
namespace {

const StageRecord* growth_stage(const Evidence& e) {
  for (const CaseRecord& c : e.results.cases())
    if (c.info.experiment == kName && c.info.method == "growth")
      for (const StageRecord& s : c.stages)
        if (s.arrays.contains("perturbation")) return &s;
  return nullptr;
}

Figure growth_figure(const Evidence& e) {
  Figure figure{.id = "growth",
                .title = "Chaos: growth with the end time",
                .columns = 3,
                .note =
                    "Geometric means of the samples. Perturbations of 1e-8 "
                    "(float: 1e-3) of the initial state; they saturate where "
                    "they become as large as the state."};
  const StageRecord* s = growth_stage(e);
  if (s == nullptr) return figure;
  const auto& time = s->arrays.at("time");
  const auto series =
      [&](const char* label, const char* method, ArrayKey array) {
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

Table growth_table(const Evidence& e) {
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
  const StageRecord* s = growth_stage(e);
  if (s == nullptr) return table;
  const auto& time = s->arrays.at("time");
  for (Index k = 0; k < time.cols(); ++k) {
    TableRow row{.label = fmt::format("{:g}", time(0, k))};
    for (const ArrayKey array :
         std::initializer_list<ArrayKey>{"gradient",
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

Section report(const Evidence& e) {
  const auto* parameters = find_sweep(e, "parameters");
  const auto* horizons = find_sweep(e, "horizons");
  Section section{
      .tables = {growth_table(e),
                 sweep_table("stability_parameters",
                             "Stability over alpha and beta, t = 25",
                             parameters),
                 sweep_table("stability_horizons",
                             "Stability over beta and end time, alpha = 1",
                             horizons)},
      .figures = {growth_figure(e),
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
  add_accuracy(section, e);
  return section;
}

}  // namespace

void add_reports(Registry& r) { r.add_report(kName, report); }

}  // namespace physinv::ks_numerics
