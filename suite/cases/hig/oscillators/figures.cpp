#include <fmt/format.h>

#include <string>
#include <vector>

#include "suite/cases/hig/common/report.h"
#include "suite/cases/hig/oscillators/oscillators.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/quantity.h"
#include "suite/evidence/training.h"
#include "suite/harness/registry.h"
#include "suite/results/published.h"
#include "suite/results/results.h"

namespace physinv::oscillators {
namespace {

/// The lowest test loss of any seed beside the paper's best runs of an hour.
Table final_losses(const Results& results, const Published& published) {
  Table table{.id = "final",
              .title = "Lowest final loss over seeds",
              .source = "Fig. 2b, Sec. 3.1",
              .digits = 9,
              .corner = "method",
              .columns = {"test loss"},
              .note = "The paper's are the best of a search, after an hour."};
  const Evidence evidence{results, published, kName};
  for (const char* id : {"adam", "gn", "hig"}) {
    Cell cell = cell_of(lowest({id}, last_loss())(evidence).value);
    if (const auto v = published.find(kName, fmt::format("fig2b/{}", id)))
      cell.paper = v->value;
    table.rows.push_back({.label = id, .cells = {cell}});
  }
  return table;
}

std::vector<MethodLine> rules(const Published& published) {
  const auto adam = paper_update(published, kName, "table3/adam/b=512"),
             hig = paper_update(published, kName, "table3/hig/b=128");
  return {{"hig", "HIG", Hue::orange, hig},
          {"gn", "Gauss-Newton", Hue::blue, hig},
          {"adam", "Adam", Hue::purple, adam},
          {"sgd", "SGD", Hue::green, adam},
          {"adagrad", "Adagrad", Hue::red, adam},
          {"adadelta", "Adadelta", {}, adam},
          {"rmsprop", "RMSprop", {}, adam}};
}

/// Lines of the methods so named, behind others that belong to the sweep.
std::vector<MethodLine> sweep(const std::string& beginning,
                              std::vector<MethodLine> lines = {}) {
  for (const auto& id : ids_with(beginning)) lines.push_back({id, id});
  return lines;
}

/// One panel per rule: test loss over updates, for each rate and batch size.
Figure grid_figure(const LearningCurves& curves,
                   const std::vector<Grid>& grids,
                   const char* id,
                   const char* source) {
  Figure figure{.id = id,
                .title = "First-order rules: rates and batch sizes",
                .source = source,
                .note = "eta / b; median over seeds."};
  for (const Grid& grid : grids) {
    std::vector<MethodLine> lines;
    for (const double rate : grid.rates)
      for (const Index b : kGridBatches)
        lines.push_back({.method = grid_id(grid.rule, rate, b),
                         .label = fmt::format("{} / {}", rate, b),
                         .key = fmt::format("{} {}", rate, b)});
    Panel panel = curves.panel(lines);
    panel.title = grid.rule;
    if (!panel.series.empty()) figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Section report(const Results& results, const Published& published) {
  std::vector<MethodLine> all = rules(published);
  for (const char* group : {"adam-b",
                            "hig-b",
                            "gn-b",
                            "kappa-",
                            "beta-",
                            "hig-tau",
                            "gn-tau",
                            "grid-"})
    for (const auto& line : sweep(group)) all.push_back(line);
  Section section{
      .experiment = kName,
      .title = "Nonlinear oscillators",
      .paper = "hig",
      .tables = {
          final_losses(results, published),
          cost_table(results,
                     kName,
                     published,
                     {{"adam-b256", "Adam, b = 256", "table3/adam/b=256"},
                      {"adam", "Adam, b = 512", "table3/adam/b=512"},
                      {"adam-b1024", "Adam, b = 1024", "table3/adam/b=1024"},
                      {"hig-b32", "HIG, b = 32", "table3/hig/b=32"},
                      {"kappa-m05", "HIG, b = 64", "table3/hig/b=64"},
                      {"hig", "HIG, b = 128", "table3/hig/b=128"}},
                     "Table 3"),
          loss_table(results, kName, all)}};
  LearningCurves curves(results, section);
  curves.losses(rules(published), "fig2b", "Learning curves", "Fig. 2b");
  curves.losses({{"hig-b32", "HIG, b = 32", Hue::red},
                 {"kappa-m05", "HIG, b = 64", Hue::green},
                 {"hig", "HIG, b = 128", Hue::orange},
                 {"adam-b256", "Adam, b = 256"},
                 {"adam", "Adam, b = 512", Hue::purple},
                 {"adam-b1024", "Adam, b = 1024"},
                 {"gn-b32", "GN, b = 32"},
                 {"kappa-m1", "GN, b = 64"},
                 {"gn", "GN, b = 128", Hue::blue}},
                "fig2c",
                "Batch sizes",
                "Fig. 2c");
  curves.add(grid_figure(
      curves, {kGrids.begin(), kGrids.end() - 1}, "fig5", "Fig. 5"));
  curves.add(grid_figure(curves, {kGrids.back()}, "fig6", "Fig. 6"));
  curves.losses(sweep("beta-", {{"kappa-m05", "beta-0", Hue::orange}}),
                "fig12a",
                "Exponent beta of the prefactor",
                "Fig. 12a");
  curves.losses(sweep("kappa-"), "fig12b", "Exponent kappa", "Fig. 12b");
  curves.losses(sweep("hig-tau", {{"kappa-m05", "hig-tau6", Hue::orange}}),
                "fig13a",
                "HIG: truncation tau",
                "Fig. 13");
  curves.losses(sweep("gn-tau", {{"kappa-m1", "gn-tau6", Hue::blue}}),
                "fig13b",
                "Gauss-Newton: truncation tau",
                "Fig. 13");
  return section;
}

const bool kReport = register_report(kName, report);

}  // namespace
}  // namespace physinv::oscillators
