// The stability atlas: all problems side by side.
#include "suite/cases/numerics/common/atlas.h"

#include <string>
#include <utility>

#include "suite/harness/registry.h"

namespace physinv {
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
    {"inaccurate", SweepCheck::forward_single, SweepStatus::inaccurate},
    {"diverges", SweepCheck::forward_single, SweepStatus::diverged},
    {"adjoint exact", SweepCheck::adjoint, SweepStatus::ok},
    {"wrong", SweepCheck::adjoint, SweepStatus::inaccurate},
    {"undecided", SweepCheck::adjoint, SweepStatus::undecided},
    {"Jacobian exact", SweepCheck::tangent, SweepStatus::ok},
    {"wrong", SweepCheck::tangent, SweepStatus::inaccurate},
    {"float adjoint good", SweepCheck::adjoint_single, SweepStatus::ok},
    {"inaccurate", SweepCheck::adjoint_single, SweepStatus::inaccurate}};

/// Every sweep of the campaign, whoever declared it.
Table side_by_side(const Results& results) {
  Table table{.id = "atlas",
              .title = "Stability of all problems",
              .digits = 0,
              .corner = "problem, sweep",
              .columns = {"points"},
              .note =
                  "Points by outcome. Float is good within 1e-3 of double, "
                  "its adjoint within 1e-2; the adjoint is exact within "
                  "1e-5 of central differences or their uncertainty, the "
                  "Jacobian within 1e-8 of the adjoint. Undecided: no step "
                  "of the differences is of use."};
  for (const Column& c : kColumns) table.columns.emplace_back(c.title);
  for (const CaseRecord& c : results.cases()) {
    for (const StageRecord& s : c.stages) {
      const auto status = s.arrays.find("status");
      if (!c.info.experiment.starts_with(kPrefix) || status == s.arrays.end() ||
          !s.arrays.contains("point"))
        continue;
      TableRow row{.label = c.info.experiment.substr(kPrefix.size()) + ", " +
                            s.stage};
      row.cells.push_back({.ours = static_cast<double>(status->second.cols())});
      for (const Column& column : kColumns)
        row.cells.push_back({.ours = static_cast<double>(
                                 sweep_count(s, column.check, column.status))});
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

Figure maps(const Results& results) {
  Figure figure{.id = "atlas",
                .title = "Where problems run",
                .columns = 3,
                .note =
                    "0 fine, 1 float inaccurate, 2 float diverged, 3 both "
                    "diverged."};
  for (const Atlas& atlas : atlases()) {
    for (const Sweep& s : atlas.sweeps) {
      const auto* found = find_sweep(results, atlas.name, "stability", s.id);
      if (found != nullptr)
        figure.panels.push_back(
            sweep_map(s.x, s.y, *found, atlas.title + ": " + s.id));
    }
  }
  return figure;
}

Section report(const Results& results, const Published&) {
  return {.tables = {side_by_side(results)}, .figures = {maps(results)}};
}

const bool kRegistered =
    register_overview({.paper = "numerics",
                       .title = "Stability atlas",
                       .profiles = {"smoke", "quick", "standard", "paper"},
                       .claims = {},
                       .report = report});

}  // namespace
}  // namespace physinv
