#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <optional>
#include <span>
#include <vector>

#include "problems/grid_poisson/grid_poisson.h"
#include "suite/cases/hig/common/jacobian_times.h"
#include "suite/cases/hig/poisson/quantities.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/field_panel.h"
#include "suite/evidence/quantity.h"
#include "suite/evidence/training.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"

namespace physinv::hig::poisson {
namespace {

/// Since when the smaller rate leads, up to the end of the larger one's curve.
Cell crossing(const Evidence& e, const char* smaller, const char* larger) {
  const auto some = first_run(e, {larger});
  if (!some) return {.text = kNotRun};
  std::optional<double> since;
  double last = 0;
  for (const double updates : some->stage->curve.iteration) {
    const auto a = median_after({smaller}, updates)(e).value,
               b = median_after({larger}, updates)(e).value;
    // Behind a first stretch in which every curve falls alike.
    if (!a || !b || updates < 100) continue;
    last = updates;
    if (*a >= *b) since.reset();
    if (*a < *b && !since) since = updates;
  }
  if (since) return {.ours = since};
  if (last > 0) return {.text = fmt::format("not within {}", last)};
  return {.text = kNotRun};
}

/// Kept singular values and the smallest of them, by method.
Table spectrum_table(const Evidence& e) {
  Table table{.id = "spectra",
              .title = "Singular values of the stacked Jacobian",
              .where = "App. B.3",
              .digits = 0,
              .corner = "method",
              .columns = {"rows m",
                          "updates seen",
                          "least kept",
                          "smallest s / s_max",
                          "unproven"},
              .note =
                  "Over all seeds. The cut is 1e-5 s_max. Gauss-Newton by a "
                  "Cholesky factorisation knows that all s are above the cut, "
                  "not where. Unproven: updates whose accuracy was not "
                  "shown."};
  for (const Phase& p : phases(e)) {
    const auto number = [](Index v) {
      return Cell{.ours = static_cast<double>(v)};
    };
    table.rows.push_back(
        {.label = p.method,
         .cells = {number(p.rows),
                   number(p.updates),
                   number(p.least_kept),
                   std::isfinite(p.smallest) ? written(p.smallest, "{:.1e}")
                                             : Cell{.text = "above the cut"},
                   number(p.unproven)}});
  }
  return table;
}

/// Where the curves of Adam's rates cross, over updates.
Table crossing_table(const Evidence& e) {
  Table table{.id = "crossings",
              .title = "From when on the smaller of two of Adam's rates leads",
              .where = "Figs. 3b, 7a",
              .digits = 0,
              .corner = "rates",
              .columns = {"updates"},
              .note = "Medians over seeds, at the measured points.",
              .keys = {"smaller rate", "larger rate"}};
  struct OfRate {
    const char *label, *method;
  };
  const OfRate least{"1e-4", "adam"}, middle{"3e-4", "adam-3e-4"},
      most{"1e-3", "adam-1e-3"};
  for (const auto& [a, b] : {std::pair(least, middle),
                             std::pair(least, most),
                             std::pair(middle, most)}) {
    table.rows.push_back({.label = fmt::format("{}, {}", a.label, b.label),
                          .cells = {crossing(e, a.method, b.method)},
                          .keys = {a.label, b.label}});
  }
  return table;
}

std::vector<MethodLine> learning(const Evidence& e) {
  const auto adam = paper_update(e, "table4/adam/b=64"),
             hig = paper_update(e, "table4/hig/b=64");
  return {{"adam", "Adam 1e-4", Hue::purple, adam},
          {"adam-3e-4", "Adam 3e-4", {}, adam},
          {"adam-1e-3", "Adam 1e-3", {}, adam},
          {"hig-001-b64", "HIG 0.01", {}, hig},
          {"hig-002-b64", "HIG 0.02", Hue::orange, hig},
          {"hig-005-b64", "HIG 0.05", {}, hig},
          {"gn-002-b64", "GN 0.02", Hue::blue},
          {"gn-1-b64", "GN 1"},
          {"hig-001-b16", "HIG 0.01, b = 16"},
          {"hig-002-b16", "HIG 0.02, b = 16", Hue::green},
          {"hig-005-b16", "HIG 0.05, b = 16"},
          {"gn-002-b16", "GN 0.02, b = 16", Hue::red},
          {"gn-1-b16", "GN 1, b = 16"},
          {"hig-b4", "HIG 0.02, b = 4"},
          {"gn-b4", "GN 0.02, b = 4"}};
}

/// From weights that Adam has trained.
std::vector<MethodLine> turns(const Evidence& e) {
  const auto adam = paper_update(e, "table4/adam/b=64"),
             hig = paper_update(e, "table4/hig/b=64");
  return {{"adam-adam", "Adam, Adam", Hue::purple, adam},
          {"adam-hig-0001-b16", "Adam, HIG 0.001, b = 16"},
          {"adam-hig-0005-b16", "Adam, HIG 0.005, b = 16"},
          {"adam-hig-002-b16", "Adam, HIG 0.02, b = 16", Hue::green},
          {"adam-hig-002-b64", "Adam, HIG 0.02", Hue::orange, hig},
          {"long-adam-adam", "Adam, Adam, later", {}, adam},
          {"long-adam-hig", "Adam, HIG 0.02, later", Hue::red, hig}};
}

const std::vector<MethodLine> kReturns = {
    {"adam", "Adam, uninterrupted", Hue::ink},
    {"adam-adam", "Adam, Adam", Hue::purple},
    {"adam-hig-adam", "Adam, HIG, Adam", Hue::orange},
    {"long-adam-adam", "Adam, Adam, later"},
    {"long-adam-hig-adam", "Adam, HIG, Adam, later", Hue::red},
    {"chain-smoke", "Adam, HIG, Adam, short"}};

Panel cells(std::string title, const Vector<double>& values) {
  constexpr FieldLayout kLayout{
      kPoissonSide, kPoissonSide, 1, kPoissonSide, 1, -0.5, -0.5};
  return field_panel(std::move(title), kLayout, values);
}

/// A source, its potential, and those that networks infer.
Figure fields(const Evidence& e, const std::vector<MethodLine>& lines) {
  Figure figure{.id = "fig3a",
                .title = "Source and inferred potentials",
                .where = "Fig. 3a",
                .columns = 4,
                .note =
                    "First example of the test set. All potentials have "
                    "one scale.",
                .picture = true};
  for (const MethodLine& line : lines) {
    const auto answer = answer_of(e, line.method);
    if (!answer) continue;
    if (figure.panels.empty()) {
      figure.panels.push_back(cells("Source", answer->wanted));
      if (answer->truth.size() > 0)
        figure.panels.push_back(cells("Potential", answer->truth));
    }
    figure.panels.push_back(cells(line.label, answer->x));
  }
  if (!figure.panels.empty())
    share_scale(std::span(figure.panels).subspan(1));
  else
    figure.panels.emplace_back();  // reads "not run"
  return figure;
}

std::vector<MethodLine> all_lines(const Evidence& e) {
  std::vector<MethodLine> all = learning(e);
  for (const auto& group : {turns(e), kReturns})
    for (const MethodLine& line : group)
      if (line.method != "adam" && line.method != "adam-adam" &&
          line.method != "long-adam-adam")
        all.push_back(line);
  return all;
}

std::vector<Table> tables(const Evidence& e,
                          const std::vector<MethodLine>& lines) {
  return {
      loss_table(e, lines),
      cost_table(
          e,
          {cost_line(kName, "adam", 64, "adam", "Adam, b = 64"),
           cost_line(kName, "hig", 64, "hig-002-b64", "HIG, b = 64"),
           {"adam-hig-002-b64", "HIG after Adam, b = 64", "table4/hig/b=64"},
           {"hig-002-b16", "HIG, b = 16", ""}},
          "Table 4"),
      spectrum_table(e),
      crossing_table(e)};
}

void add_curves(LearningCurves& curves, const Evidence& e) {
  const auto some = [lines =
                         learning(e)](std::initializer_list<const char*> ids) {
    std::vector<MethodLine> found;
    for (const MethodLine& line : lines)
      for (const char* id : ids)
        if (line.method == id) found.push_back(line);
    return found;
  };
  curves.losses(some({"adam",
                      "adam-3e-4",
                      "adam-1e-3",
                      "hig-001-b64",
                      "hig-002-b64",
                      "hig-005-b64"}),
                "fig3b",
                "Learning curves, b = 64",
                "Figs. 3b, 7a");
  curves.losses(some({"adam",
                      "hig-002-b16",
                      "hig-002-b64",
                      "gn-002-b16",
                      "gn-1-b16",
                      "gn-002-b64",
                      "gn-1-b64",
                      "hig-b4",
                      "gn-b4"}),
                "fig7a",
                "Small batches, and Gauss-Newton beside HIG",
                "Fig. 7a");
  curves.losses(
      turns(e), "fig3c", "From weights that Adam has trained", "Fig. 3c");
  curves.chains(
      kReturns, "fig7b", "Adam, then HIG, then Adam again", "Fig. 7b");
}

Section report(const Evidence& e) {
  const auto lines = all_lines(e);
  Section section{.tables = tables(e, lines),
                  .method_titles = titles_of(lines)};
  LearningCurves curves(e, section);
  section.figures.push_back(
      fields(e,
             {{"adam", "Adam"},
              {"hig-002-b64", "HIG"},
              {"hig-002-b16", "HIG, b = 16"},
              {"adam-hig-002-b64", "Adam, then HIG"},
              {"adam-hig-002-b16", "Adam, then HIG, b = 16"},
              {"chain-smoke", "Adam, HIG, Adam, short"}}));
  add_curves(curves, e);
  return section;
}

}  // namespace

void add_reports(Registry& r) {
  r.add_report(kName, report);
  add_jacobian_report(r, kName);
}

}  // namespace physinv::hig::poisson
