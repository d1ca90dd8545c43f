#include "whose_bfgs.h"

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "against.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/statistics.h"
#include "suite/harness/registry.h"
#include "suite/results/published.h"
#include "whose_bfgs_claims.h"

namespace libraries {
namespace {

using physinv::against;
using physinv::Cell;
using physinv::Equality;
using physinv::Evidence;
using physinv::Index;
using physinv::Measured;
using physinv::Quantity;
using physinv::Series;

/// By where solvers end, not by when they stop.
constexpr Equality kSameEnd{.relative = 1e-3, .both_below = 1e-6};

struct Column {
  const char* head;
  physinv::Select (*of)();
  physinv::Share share;
  Equality equality = Equality::strict;
  const char* printed = "";
};

const std::vector<Column>& columns() {
  static const std::vector<Column> kColumns = {
      {"better", fit, better, Equality::strict, "table4/jpo/better"},
      {"equal", fit, equal, Equality::strict, "table4/jpo/equal"},
      {"f", fit, f},
      {"refined better",
       refined,
       better,
       Equality::strict,
       "table5/jpo/better"},
      {"refined equal", refined, equal, Equality::strict, "table5/jpo/equal"},
      {"refined f", refined, f},
      {"refined f, same end", refined, f, kSameEnd}};
  return kColumns;
}

physinv::Table table(const std::string& varied, const Evidence& e) {
  physinv::Table table{
      .id = "whose-bfgs",
      .title = "Problems with better or equal solutions by joint optimization",
      .where = "Tables 4 and 5, Fig. 11",
      .unit = "%",
      .corner = "against",
      .note =
          "Means over n, then mean ± sample standard deviation over seeds; "
          "f = better + equal / 2. Equal is bit by bit; in the last column "
          "also within 0.1 % of the solver's loss, and where both are below "
          "1e-6. bfgs is the suite's, which follows SciPy's; the paper's "
          "numbers are next to it. Rows named bfgs-... differ from it in the "
          "length of their first trial, those with back-off halve their step "
          "at NaN."};
  for (const Column& c : columns()) table.columns.push_back(c.head);
  for (const std::string& solver : solvers_of(e)) {
    physinv::TableRow row{.label = solver};
    for (const Column& c : columns()) {
      const Quantity q =
          percent(mean(c.of(), against({solver}, c.share, c.equality)));
      Cell cell = physinv::cell_of(q(e));
      if (solver == "bfgs" && *c.printed != '\0')
        cell = beside_printed(
            std::move(cell), e, varied + ' ' + std::string(c.printed));
      row.cells.push_back(std::move(cell));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Series over_n(const std::string& solver, const Evidence& e) {
  std::map<Index, std::vector<double>> values;
  for (const auto& s : sample(e, refined(), against({solver}, f)))
    values[s.n].push_back(s.value);
  Series series{.label = solver, .method = solver, .markers = true};
  for (const auto& [n, of_seeds] : values) {
    series.x.push_back(static_cast<double>(n));
    series.y.push_back(physinv::mean_of(of_seeds));
  }
  return series;
}

physinv::Figure figure(const Evidence& e) {
  physinv::Panel panel{
      .title = "", .x_label = "n", .y_label = "f_N", .x_log = true};
  for (const std::string& solver : solvers_of(e)) {
    auto series = over_n(solver, e);
    if (!series.x.empty()) panel.series.push_back(std::move(series));
  }
  panel.y_min = 0, panel.y_max = 1;
  return {.id = "whose-bfgs",
          .title = "Refined joint optimization against each library's solver",
          .where = "Fig. 11",
          .panels = {std::move(panel)},
          .columns = 1,
          .note = "Above 1/2 joint optimization is better on more problems."};
}

/// f of refined JPO in per cent, as the paper prints it; empty if it does not.
std::optional<double> printed_f(const std::string& problem, const Evidence& e) {
  const auto better = e.published.find("jpo/" + problem, "table5/jpo/better"),
             equal = e.published.find("jpo/" + problem, "table5/jpo/equal");
  if (!better || !equal) return {};
  return better->value + equal->value / 2;
}

/// A point for each solver, at its place among them.
Series by_solver(const char* label,
                 const std::vector<std::string>& solvers,
                 const Evidence& e,
                 Equality equality) {
  Series series{
      .label = label, .method = label, .line = false, .markers = true};
  for (std::size_t i = 0; i < solvers.size(); ++i) {
    const Measured m =
        percent(mean(refined(), against({solvers[i]}, f, equality)))(e);
    const double spread = m.spread.value_or(0);
    series.x.push_back(static_cast<double>(i));
    series.y.push_back(*m.value);
    series.lo.push_back(*m.value - spread);
    series.hi.push_back(*m.value + spread);
  }
  return series;
}

std::vector<std::string> libraries_of(const Evidence& e) {
  auto all = solvers_of(e);
  std::erase_if(all, [&](const std::string& solver) {
    return solver.starts_with("bfgs-");  // a setting of the suite's
  });
  return all;
}

physinv::Panel glance_panel(const std::string& problem, const Evidence& all) {
  const Evidence e = all.of(study_of(problem));
  const auto solvers = libraries_of(e);
  const double end = static_cast<double>(solvers.size()) - 0.5;
  physinv::Panel panel{
      .title = physinv::registry().find("jpo/" + problem)->title,
      .x_label = "solver",
      .y_label = "f, %"};
  // Without values a field only names the places along x.
  panel.field = physinv::Field2D{};
  panel.field->x_names = solvers;
  panel.x_min = -0.5, panel.x_max = end, panel.y_min = 0, panel.y_max = 100;
  panel.series = {by_solver("equal bit by bit", solvers, e, Equality::strict),
                  by_solver("equal ends count as equal", solvers, e, kSameEnd)};
  panel.series.back().dashed = true;  // hollow
  if (const auto paper = printed_f(problem, e))
    panel.series.push_back({.label = "paper",
                            .method = "paper",
                            .x = {-0.5, end},
                            .y = {*paper, *paper},
                            .dashed = true});
  return panel;
}

}  // namespace

physinv::Figure at_a_glance(const Evidence& e) {
  physinv::Figure figure{
      .id = "solvers",
      .title = "How often refined joint optimization ends below each solver",
      .where = "Table 5",
      .columns = 2,
      .note =
          "f = better + equal / 2: mean over n, then mean and sample "
          "standard deviation over seeds. Hollow: losses within 0.1 % of "
          "each other, or both below 1e-6, count as equal. Dashed: the "
          "paper, against SciPy's BFGS, which bfgs follows."};
  for (const std::string& problem : section4())
    figure.panels.push_back(glance_panel(problem, e));
  return figure;
}

physinv::Section whose_bfgs(const std::string& varied, const Evidence& e) {
  return {.tables = {table(varied, e)}, .figures = {figure(e)}};
}

}  // namespace libraries
