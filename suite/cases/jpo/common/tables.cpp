#include <fmt/format.h>

#include <algorithm>

#include "suite/cases/jpo/common/report.h"
#include "suite/evidence/failures.h"
#include "suite/evidence/guests.h"
#include "suite/evidence/method_titles.h"
#include "suite/evidence/statistics.h"

namespace physinv {
namespace {

struct SecondsColumn {
  const char *title, *method, *stage;
};

constexpr SecondsColumn kSecondsColumns[] = {
    {"Parallel BFGS", "bfgs", "solve"},
    {"Network fit", "jpo", "fit"},
    {"Refinement", "jpo", "refine"},
    {"Supervised fit", "supervised", "fit"},
    {"Sup. refinement", "supervised", "refine"},
    {"Surrogate fit", "na", "fit"},
    {"Neural adjoint", "na", "solve"},
    {"N.A. refinement", "na", "refine"}};

// Columns of one table may need other digits than its unit suggests.
Cell shown_as(Cell cell, const char* format) {
  if (!cell.ours) return cell;
  cell.text = fmt::format(fmt::runtime(format), *cell.ours);
  if (cell.spread) {
    cell.text += " ± " + fmt::format(fmt::runtime(format), *cell.spread);
  }
  return cell;
}

std::string list(std::span<const Index> sizes) {
  return fmt::format("{}", fmt::join(sizes, ", "));
}

}  // namespace

Cell JpoReport::with_paper(Cell cell, const std::string& quantity) const {
  return beside_printed(std::move(cell), evidence_, quantity);
}

Cell JpoReport::over_seeds(const Select& runs,
                           Index n,
                           const RunValue& value) const {
  if (const auto failed = failed_text(evidence_, jpo::at(runs, n));
      !failed.empty())
    return {.text = failed};
  return cell_of(values(runs, n, value));
}

/// Per cent of all runs, and the deviation of each seed's mean; compared with
/// BFGS.
Cell JpoReport::over_runs(const Select& runs, const RunValue& share) const {
  for (const Select& each : {runs, jpo::bfgs()})
    if (const auto failed = failed_text(evidence_, each); !failed.empty())
      return {.text = failed};
  const auto all = sample(evidence_, runs, share);
  if (all.empty()) return {.text = kNotRun};
  Cell cell{.ours = 100 * mean_of(values_of(all))};
  if (const auto deviation = mean_std(seed_means(all))->std)
    cell.spread = 100 * *deviation;
  return cell;
}

Cell JpoReport::seconds_cell(const Select& runs,
                             Index n,
                             TimedStages& timed) const {
  bool crowded = false;
  Cell cell = over_seeds(runs, n, [&](const Run& run) {
    crowded = crowded || run.stage->crowded;
    return timed.seconds(*run.stage);
  });
  if (!cell.ours && crowded) cell.text = kCrowded;
  return cell;
}

Table JpoReport::seconds() const {
  Table table{.id = "table2",
              .title = "Training and optimization times at the largest n",
              .where = "Table 2",
              .unit = "CPU s",
              .digits = 1,
              .keys = {"problem"},
              .across = Across{.key = "procedure", .quantities = {"time"}}};
  const Index n = largest_size();
  TableRow row{.label = title()};
  TimedStages timed;
  for (const auto& [title, method, stage] : kSecondsColumns) {
    // BFGS alone has one stage only, so the paper's number names none.
    std::string published = fmt::format("table2/{}", method);
    if (std::string_view(method) != "bfgs") {
      published += fmt::format("/{}", stage);
    }
    table.columns.emplace_back(title);
    row.cells.push_back(
        with_paper(seconds_cell({method, stage}, n, timed), published));
  }
  table.rows.push_back(std::move(row));
  table.note = fmt::format(
      "n = {}; mean ± sample standard deviation over seeds. {} The paper's "
      "machine was another one.",
      n,
      timed.note());
  return table;
}

Table JpoReport::fit_share() const {
  Table table{.id = "table3",
              .title = "Share of the loss decrease made by the network fit",
              .where = "Table 3",
              .unit = "%",
              .digits = 1,
              .keys = {"problem"},
              .across = Across{.key = "n", .quantities = {"share"}}};
  TableRow row{.label = title()};
  for (const Index n : options_.table3_sizes) {
    table.columns.push_back(fmt::format("n = {}", n));
    table.across->values.push_back(std::to_string(n));
    const Select runs = jpo::at(jpo::refined("jpo"), n);
    const Cell cell =
        over_runs(runs, jpo::decrease_before(options_.from_prior));
    row.cells.push_back(with_paper(cell, fmt::format("table3/n={}", n)));
  }
  table.rows.push_back(std::move(row));
  table.note =
      "Per problem (L_start - L_fit) / (L_start - L_refined), mean over "
      "problems, then mean ± sample standard deviation over seeds. Problems "
      "without any decrease are left out.";
  return table;
}

Table JpoReport::better_equal(bool refined) const {
  const std::string id = refined ? "table5" : "table4";
  Table table{
      .id = id,
      .title = fmt::format("Problems with better or equal solutions than "
                           "BFGS, {} refinement",
                           refined ? "with" : "without"),
      .where = refined ? "Table 5" : "Table 4",
      .unit = "%",
      .digits = 1,
      .corner = "equality",
      .across = Across{.key = "method", .quantities = {"better", "equal"}}};
  for (const std::string& method : options_.methods) {
    table.across->values.push_back(method_title(method));
    table.columns.push_back(method_title(method) + " better");
    table.columns.push_back(method_title(method) + " equal");
  }
  for (const Equality equality : {Equality::strict, Equality::tol}) {
    const bool strict = equality == Equality::strict;
    TableRow row{.label = strict ? "strict" : "tol"};
    for (const std::string& method : options_.methods) {
      const Select runs = jpo::ending(method, refined);
      const Cell better = over_runs(runs, jpo::better(equality)),
                 equal = over_runs(runs, jpo::equal(equality));
      const std::string name = id + "/" + method;
      row.cells.push_back(strict ? with_paper(better, name + "/better")
                                 : better);
      row.cells.push_back(strict ? with_paper(equal, name + "/equal") : equal);
    }
    table.rows.push_back(std::move(row));
  }
  table.note = fmt::format(
      "Mean over n = {} and seeds; ± sample standard deviation over seeds of "
      "each seed's mean. strict: equal losses bit by bit; tol: |a - b| <= "
      "1e-6 |b|.",
      list(sizes()));
  return table;
}

Table JpoReport::results_table() const {
  Table table{.id = "results",
              .title = title() + " by n and method",
              .digits = 3,
              .corner = "n, method",
              .columns = {"solved",
                          "mean loss",
                          "f_N strict",
                          "f_N tol",
                          "iterations",
                          "CPU seconds"},
              .keys = {"n", "method", "refined"}};
  TimedStages timed;
  const auto present = evidence_.results.methods(evidence_.experiment);
  const bool gd = std::count(present.begin(), present.end(), "gd") > 0;
  for (const Index n : sizes()) {
    table.rows.push_back(results_row("bfgs", n, false, timed));
    if (gd) table.rows.push_back(results_row("gd", n, false, timed));
    for (const std::string& method : options_.methods) {
      table.rows.push_back(results_row(method, n, false, timed));
      table.rows.push_back(results_row(method, n, true, timed));
    }
    for (const std::string& method : guests(evidence_))
      table.rows.push_back(results_row(method, n, false, timed));
  }
  table.note = fmt::format(
      "Mean ± sample standard deviation over seeds. solved: share of problems "
      "with {}. f_N: share better than BFGS plus half the share equal "
      "to it. Iterations: mean over problems. Seconds: all stages of the row, "
      "a refined row counts the refinement alone. {}",
      options_.solved.says(),
      timed.note());
  return table;
}

TableRow JpoReport::results_row(const std::string& method,
                                Index n,
                                bool refined,
                                TimedStages& timed) const {
  using Value = std::optional<double>;
  const Select runs = ending(method, refined);
  const auto f = [&](Equality equality) {
    if (method == "bfgs") return Cell{.text = kNothing};
    const auto failed = failed_text(evidence_, jpo::at(jpo::bfgs(), n));
    return failed.empty() ? over_seeds(runs, n, jpo::f(equality))
                          : Cell{.text = failed};
  };
  const RunValue iterations = [](const Run& run) -> Value {
    const auto& own = run.stage->example_iterations;
    return own.size() > 0 ? own.mean()
                          : static_cast<double>(run.stage->iterations);
  };
  const RunValue seconds = [&](const Run& run) -> Value {
    double sum = 0;
    for (const StageRecord& s : run.record->stages) {
      if ((s.stage == "refine") != refined) continue;
      const auto own = timed.seconds(s);
      if (!own) return {};
      sum += *own;
    }
    return sum;
  };
  const Cell loss = over_seeds(runs, n, jpo::mean_loss());
  Cell time = over_seeds(runs, n, seconds);
  if (!time.ours && loss.ours) time.text = kCrowded;
  return {
      .label = fmt::format(
          "{} {}{}", n, method_title(method), refined ? " refined" : ""),
      .cells = {over_seeds(runs, n, jpo::solved(options_.solved)),
                shown_as(loss, "{:.2e}"),
                f(Equality::strict),
                f(Equality::tol),
                shown_as(over_seeds(runs, n, iterations), "{:.1f}"),
                time},
      .keys = {std::to_string(n), method_title(method), refined ? "1" : "0"}};
}

}  // namespace physinv
