#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "problems/oscillators/oscillators.h"
#include "suite/cases/hig/common/jacobian_times.h"
#include "suite/cases/hig/oscillators/oscillators.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/options.h"
#include "suite/evidence/quantity.h"
#include "suite/evidence/series.h"
#include "suite/evidence/training.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"
#include "suite/results/results.h"

namespace physinv::oscillators {
namespace {

/// The lowest test loss of any seed next to the paper's best runs of an hour.
Table final_losses(const Evidence& evidence) {
  Table table{.id = "final",
              .title = "Lowest final loss over seeds",
              .where = "Fig. 2b, Sec. 3.1",
              .digits = 9,
              .corner = "method",
              .columns = {"test loss"},
              .note = "The paper's are the best of a search, after an hour."};
  for (const std::string id : {"adam", "gn", "hig"})
    table.rows.push_back(
        {.label = id,
         .cells = {beside_printed(cell_of(lowest_at_end({id})(evidence).value),
                                  evidence,
                                  "fig2b/" + id)}});
  return table;
}

std::vector<MethodLine> rules(const Evidence& e) {
  const auto adam = paper_update(e, "table3/adam/b=512"),
             hig = paper_update(e, "table3/hig/b=128");
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
                   const char* where) {
  Figure figure{.id = id,
                .title = "First-order rules: rates and batch sizes",
                .where = where,
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

/// The pair under the control that a network chose, from the given state back
/// to it.
Panel time_evolution(const Answered& answer, std::string title) {
  const OscillatorsOptions physics;
  const char* const names[] = {"x1", "x2", "p1", "p2"};
  Panel panel{.title = std::move(title), .x_label = "time"};
  constexpr Hue kHues[] = {Hue::blue, Hue::orange, Hue::teal, Hue::pink};
  Series control{.label = "control u",
                 .method = "u",
                 .dashed = true,
                 .style = PlotStyle{Hue::grey, Marker::circle}};
  std::vector<Series> states;
  for (std::size_t k = 0; k < 4; ++k)
    states.push_back({.label = names[k],
                      .method = names[k],
                      .style = PlotStyle{kHues[k], Marker::circle}});
  std::array<double, 4> state{};
  std::copy_n(answer.given.data(), 4, state.begin());
  for (Index n = 0; n <= answer.x.size(); ++n) {
    const double time = physics.dt * static_cast<double>(n);
    for (std::size_t k = 0; k < 4; ++k) {
      states[k].x.push_back(time);
      states[k].y.push_back(state[k]);
    }
    if (n == answer.x.size()) break;
    control.x.push_back(time);
    control.y.push_back(answer.x(n));
    state = oscillators_step<double>(state, answer.x(n), physics).y;
  }
  panel.series = std::move(states);
  panel.series.push_back(std::move(control));
  const double end = physics.dt * static_cast<double>(answer.x.size());
  for (std::size_t k = 0; k < 4; ++k)
    panel.series.push_back(mark(std::string(names[k]) + " wanted",
                                names[k],
                                end,
                                answer.wanted(static_cast<Index>(k))));
  return panel;
}

Figure evolution_figure(const Evidence& e,
                        const std::vector<MethodLine>& lines) {
  Figure figure{.id = "fig2a",
                .title = "Time evolution controlled by a network",
                .where = "Fig. 2a",
                .note = "First example of the test set; marks: what is wanted.",
                .picture = true};
  for (const MethodLine& line : lines)
    if (const auto answer = answer_of(e, line.method))
      figure.panels.push_back(time_evolution(*answer, line.label));
  if (figure.panels.empty()) figure.panels.emplace_back();  // reads "not run"
  return figure;
}

/// What the runs were made with, next to the paper's.
Table hyperparameters(const Evidence& evidence) {
  Table table{.id = "table2",
              .title = "Hyperparameters of Fig. 2b",
              .where = "Table 2",
              .digits = 7,
              .corner = "method",
              .columns = {"b", "eta", "tau"}};
  struct Hyperparameter {
    const char *option, *printed;
  };
  constexpr Hyperparameter kShown[] = {
      {"batch", "/b"}, {"rate", "/eta"}, {"tau", "/tau"}};
  for (const MethodLine& line : rules(evidence)) {
    const auto run = first_run(evidence, {line.method});
    TableRow shown{.label = line.label};
    for (const auto& [option, printed] : kShown)
      shown.cells.push_back(
          run ? beside_printed(
                    cell_of(number_of(run->stage->options, option), kNothing),
                    evidence,
                    "table2/" + line.method + printed)
              : Cell{.text = kNotRun});
    table.rows.push_back(std::move(shown));
  }
  return table;
}

std::vector<Table> tables(const Evidence& e) {
  std::vector<MethodLine> all = rules(e);
  for (const char* group : {"adam-b",
                            "hig-b",
                            "gn-b",
                            "kappa-",
                            "beta-",
                            "hig-tau",
                            "gn-tau",
                            "grid-"})
    for (const auto& line : sweep(group)) all.push_back(line);
  return {
      final_losses(e),
      hyperparameters(e),
      cost_table(
          e,
          {hig::cost_line(kName, "adam", 256, "adam-b256", "Adam, b = 256"),
           hig::cost_line(kName, "adam", 512, "adam", "Adam, b = 512"),
           hig::cost_line(kName, "adam", 1024, "adam-b1024", "Adam, b = 1024"),
           hig::cost_line(kName, "hig", 32, "hig-b32", "HIG, b = 32"),
           hig::cost_line(kName, "hig", 64, "kappa-m05", "HIG, b = 64"),
           hig::cost_line(kName, "hig", 128, "hig", "HIG, b = 128")},
          "Table 3"),
      loss_table(e, all)};
}

void add_curves(LearningCurves& curves, const Evidence& e) {
  curves.losses(rules(e), "fig2b", "Learning curves", "Fig. 2b");
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
}

Section report(const Evidence& e) {
  Section section{.tables = tables(e), .method_titles = titles_of(rules(e))};
  LearningCurves curves(e, section);
  section.figures.push_back(evolution_figure(
      e, {{"hig", "HIG"}, {"adam", "Adam"}, {"gn", "Gauss-Newton"}}));
  add_curves(curves, e);
  return section;
}

}  // namespace

void add_reports(Registry& r) {
  r.add_report(kName, report);
  hig::add_jacobian_report(r, kName);
}

}  // namespace physinv::oscillators
