#include "whose_bfgs.h"

#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "suite/core/check.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/statistics.h"
#include "suite/harness/registry.h"
#include "suite/results/results.h"

namespace libraries {
namespace {

using physinv::Cell;
using physinv::Evidence;
using physinv::Index;
using physinv::Quantity;
using physinv::Run;
using physinv::Select;

constexpr Equal kTables{}, kSameEnd{.relative = 1e-3, .solved = 1e-6};

const Select kFit{"jpo", "fit"}, kRefined{"jpo", "refine"};

physinv::RunValue against(const std::string& solver,
                          double (*share)(const Shares&),
                          Equal equal = kTables) {
  return [=](const Run& run) -> std::optional<double> {
    const auto other = run.beside({solver});
    if (!other) return {};
    return share(shares(run.stage->loss, other->stage->loss, equal));
  };
}

double better(const Shares& s) { return s.better; }
double equal(const Shares& s) { return s.equal; }
double f(const Shares& s) { return s.f(); }

struct Column {
  const char* head;
  const Select& of;
  double (*share)(const Shares&);
  Equal equal = kTables;
  const char* printed = "";
};

const std::vector<Column>& columns() {
  static const std::vector<Column> kColumns = {
      {"better", kFit, better, kTables, "table4/jpo/better"},
      {"equal", kFit, equal, kTables, "table4/jpo/equal"},
      {"f", kFit, f},
      {"refined better", kRefined, better, kTables, "table5/jpo/better"},
      {"refined equal", kRefined, equal, kTables, "table5/jpo/equal"},
      {"refined f", kRefined, f},
      {"refined f, same end", kRefined, f, kSameEnd}};
  return kColumns;
}

/// Solvers by themselves, in the order of the experiment.
std::vector<std::string> solvers(const Evidence& e) {
  std::vector<std::string> all;
  for (const auto& method : physinv::registry().find(e.experiment)->methods)
    if (method.chain.front()->name() == "solve") all.push_back(method.id);
  for (const auto& id : e.results.methods(e.experiment))
    if (physinv::find_method(*physinv::registry().find(e.experiment), id) ==
        nullptr)
      all.push_back(id);
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
          "numbers "
          "stand beside it."};
  for (const Column& c : columns()) table.columns.push_back(c.head);
  for (const std::string& solver : solvers(e)) {
    physinv::TableRow row{.label = solver};
    for (const Column& c : columns()) {
      const Quantity q = percent(mean(c.of, against(solver, c.share, c.equal)));
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
  for (const auto& s : sample(e, kRefined, against(solver, f)))
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

Shares shares(const physinv::Vector<double>& losses,
              const physinv::Vector<double>& others,
              Equal equal) {
  SUITE_CHECK(losses.size() == others.size() && losses.size() > 0,
              "losses of the same problems");
  Shares s;
  for (Index i = 0; i < losses.size(); ++i) {
    const double a = losses(i), b = others(i);
    if (!std::isfinite(a)) continue;
    const bool near =
        (a < equal.solved && b < equal.solved) ||
        (std::isfinite(b) && std::abs(a - b) <= equal.relative * std::abs(b));
    if (a == b || near)
      s.equal += 1;
    else if (!(a >= b))
      s.better += 1;
  }
  const auto n = static_cast<double>(losses.size());
  return {s.better / n, s.equal / n};
}

physinv::Section whose_bfgs(const std::string& varied, const Evidence& e) {
  return {.tables = {table(varied, e)}, .figures = {figure(e)}};
}

}  // namespace libraries
