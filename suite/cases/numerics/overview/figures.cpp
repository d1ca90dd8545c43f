// The atlas: what accuracy costs and where it ends, all problems side by side.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "suite/cases/numerics/common/atlas.h"
#include "suite/cases/numerics/common/sweep_report.h"
#include "suite/evidence/cell.h"
#include "suite/harness/registry.h"

namespace physinv::numerics::overview {
namespace {

const std::string kPrefix = "numerics/";

struct Column {
  const char* title;
  SweepCheck check;
  SweepStatus status;
};
const std::vector<Column> kColumns = {
    {"double diverges", SweepCheck::forward_double, SweepStatus::diverged},
    {"float good", SweepCheck::forward_single, SweepStatus::ok},
    {"float inaccurate", SweepCheck::forward_single, SweepStatus::inaccurate},
    {"float diverges", SweepCheck::forward_single, SweepStatus::diverged},
    {"adjoint exact", SweepCheck::adjoint, SweepStatus::ok},
    {"adjoint wrong", SweepCheck::adjoint, SweepStatus::inaccurate},
    {"adjoint undecided", SweepCheck::adjoint, SweepStatus::undecided},
    {"Jacobian exact", SweepCheck::tangent, SweepStatus::ok},
    {"Jacobian wrong", SweepCheck::tangent, SweepStatus::inaccurate},
    {"float adjoint good", SweepCheck::adjoint_single, SweepStatus::ok},
    {"float adjoint inaccurate",
     SweepCheck::adjoint_single,
     SweepStatus::inaccurate}};

/// Every sweep of the campaign, of all experiments.
Table side_by_side(const Evidence& e) {
  Table table{
      .id = "atlas",
      .title = "Stability of all problems",
      .digits = 0,
      .corner = "problem, sweep",
      .columns = {"points"},
      .note =
          "Points by outcome. Float is good within 1e-3 of double, its adjoint "
          "within 1e-2; the adjoint is exact within 1e-5 of central "
          "differences or their uncertainty, the Jacobian within 1e-8 of the "
          "adjoint. Undecided: no step of the differences is useful.",
      .keys = {"problem", "sweep"}};
  for (const Column& c : kColumns) table.columns.emplace_back(c.title);
  for (const CaseRecord& c : e.results.cases()) {
    for (const StageRecord& s : c.stages) {
      const auto status = s.arrays.find("status");
      if (!c.info.experiment.starts_with(kPrefix) || status == s.arrays.end() ||
          !s.arrays.contains("point"))
        continue;
      const std::string problem = c.info.experiment.substr(kPrefix.size());
      TableRow row{.label = problem + ", " + s.stage,
                   .keys = {problem, s.stage}};
      row.cells.push_back({.ours = static_cast<double>(status->second.cols())});
      for (const Column& column : kColumns)
        row.cells.push_back({.ours = static_cast<double>(
                                 sweep_count(s, column.check, column.status))});
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

Figure maps(const Evidence& e) {
  Figure figure{.id = "atlas",
                .title = "Where problems run",
                .columns = 3,
                .note =
                    "0 fine, 1 float inaccurate, 2 float diverged, 3 both "
                    "diverged."};
  for (const Atlas& atlas : atlases()) {
    for (const Sweep& s : atlas.sweeps) {
      const auto* found = find_sweep(e.of(atlas.name), s.id);
      if (found != nullptr)
        figure.panels.push_back(
            sweep_map(s.x, s.y, *found, atlas.title + ": " + s.id));
    }
  }
  return figure;
}

bool asks(const std::vector<Measurement>& all, WorkOf of) {
  return std::any_of(
      all.begin(), all.end(), [of](const auto& m) { return m.of == of; });
}

/// What accuracy costs, at the fastest setting that reaches it.
Table times_to_accuracy(const Evidence& e) {
  Table table{.id = "accuracy",
              .title = "Time to an accuracy",
              .corner = "problem",
              .columns = {},
              .note =
                  "Microseconds per sample of the fastest setting whose median "
                  "relative error is at most the number on top, and which it "
                  "is. Dominated: settings that another one beats in time "
                  "and error; the pages of the problems name them."};
  const std::vector<double> targets = {1e-3, 1e-6, 1e-9};
  constexpr WorkOf kAll[] = {
      WorkOf::forward, WorkOf::gradient, WorkOf::inverse};
  for (const WorkOf of : kAll)
    for (const double target : targets)
      table.columns.push_back(fmt::format("{} {:.0e}", to_string(of), target));
  table.columns.insert(table.columns.end(), {"settings", "dominated"});
  for (const auto& [experiment, parameters] : all_parameters()) {
    const auto all = measurements(e.of(experiment));
    TableRow row{.label = experiment.substr(kPrefix.size())};
    for (const WorkOf of : kAll) {
      for (const double target : targets) {
        const auto* m = fastest_within(all, of, target);
        if (m != nullptr) {
          const double us = 1e6 * m->seconds;
          row.cells.push_back(
              {.ours = us,
               .text = fmt::format("{:.3g} ({})", us, m->setting),
               .of = m->setting});
          continue;
        }
        row.cells.push_back({.text = all.empty()      ? kNotRun
                                     : !asks(all, of) ? "no inverse"
                                                      : "not reached"});
      }
    }
    const auto dominated =
        std::count_if(all.begin(), all.end(), [&](const Measurement& m) {
          return dominated_by(all, m) != nullptr;
        });
    for (const auto count :
         {static_cast<double>(all.size()), static_cast<double>(dominated)})
      row.cells.push_back(written(count, "{:g}"));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Section report(const Evidence& e) {
  return {.tables = {times_to_accuracy(e), side_by_side(e)},
          .figures = {maps(e)}};
}

}  // namespace

void add_reports(Registry& r) {
  r.add(Overview{.paper = "numerics",
                 .title = "Accuracy and stability of all problems",
                 .profiles = {"smoke", "quick", "standard", "paper"},
                 .claims = {},
                 .report = report});
}

}  // namespace physinv::numerics::overview
