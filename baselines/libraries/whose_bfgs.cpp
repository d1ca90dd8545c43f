#include "whose_bfgs.h"

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "suite/evidence/cell.h"
#include "suite/evidence/shares.h"
#include "suite/evidence/statistics.h"
#include "suite/harness/registry.h"
#include "suite/results/results.h"

namespace libraries {
namespace {

using physinv::Cell;
using physinv::Equality;
using physinv::Evidence;
using physinv::Index;
using physinv::Quantity;
using physinv::Run;
using physinv::Select;
using physinv::Shares;

/// By where solvers end, not by when they stop.
constexpr Equality kSameEnd{.relative = 1e-3, .both_below = 1e-6};

const Select kFit{"jpo", "fit"}, kRefined{"jpo", "refine"};

physinv::RunValue against(const std::string& solver,
                          double (*share)(const Shares&),
                          Equality equality) {
  return [=](const Run& run) -> std::optional<double> {
    const auto other = run.beside({solver});
    if (!other) return {};
    return share(
        physinv::compare_losses(run.stage->loss, other->stage->loss, equality));
  };
}

double better(const Shares& s) { return s.better; }
double equal(const Shares& s) { return s.equal; }
double f(const Shares& s) { return s.f(); }

struct Column {
  const char* head;
  const Select& of;
  double (*share)(const Shares&);
  Equality equality = Equality::strict;
  const char* printed = "";
};

const std::vector<Column>& columns() {
  static const std::vector<Column> kColumns = {
      {"better", kFit, better, Equality::strict, "table4/jpo/better"},
      {"equal", kFit, equal, Equality::strict, "table4/jpo/equal"},
      {"f", kFit, f},
      {"refined better",
       kRefined,
       better,
       Equality::strict,
       "table5/jpo/better"},
      {"refined equal", kRefined, equal, Equality::strict, "table5/jpo/equal"},
      {"refined f", kRefined, f},
      {"refined f, same end", kRefined, f, kSameEnd}};
  return kColumns;
}

/// Solvers by themselves, in the order of the experiment.
std::vector<std::string> solvers(const Evidence& e) {
  const auto experiment = physinv::registry().find(e.experiment);
  std::vector<std::string> all;
  for (const auto& method : experiment->methods)
    if (method.chain.front()->name() == "solve") all.push_back(method.id);
  for (const auto& id : e.results.methods(e.experiment))
    if (physinv::find_method(*experiment, id) == nullptr) all.push_back(id);
  return all;
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
  for (const std::string& solver : solvers(e)) {
    physinv::TableRow row{.label = solver};
    for (const Column& c : columns()) {
      const Quantity q =
          percent(mean(c.of, against(solver, c.share, c.equality)));
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

physinv::Series over_n(const std::string& solver, const Evidence& e) {
  std::map<Index, std::vector<double>> values;
  for (const auto& s :
       sample(e, kRefined, against(solver, f, Equality::strict)))
    values[s.n].push_back(s.value);
  physinv::Series series{.label = solver, .method = solver, .markers = true};
  for (const auto& [n, of_seeds] : values) {
    series.x.push_back(static_cast<double>(n));
    series.y.push_back(physinv::mean_of(of_seeds));
  }
  return series;
}

physinv::Figure figure(const Evidence& e) {
  physinv::Panel panel{
      .title = "", .x_label = "n", .y_label = "f_N", .x_log = true};
  for (const std::string& solver : solvers(e)) {
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

}  // namespace

physinv::Section whose_bfgs(const std::string& varied, const Evidence& e) {
  return {.tables = {table(varied, e)}, .figures = {figure(e)}};
}

}  // namespace libraries
