#include "suite/cases/numerics/common/sweep_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "suite/cases/common/claims.h"
#include "suite/core/power_of_ten.h"
#include "suite/core/whole.h"
#include "suite/evidence/cell.h"

namespace physinv {
namespace {

SweepStatus status_of(const StageRecord& sweep, SweepCheck check, Index cell) {
  return static_cast<SweepStatus>(whole_part<int>(
      sweep.arrays.at("status")(static_cast<Index>(check), cell)));
}

Index cells(const StageRecord& sweep) {
  return sweep.arrays.at("status").cols();
}

/// 0 fine, 1 float inaccurate, 2 float diverged, 3 both diverged.
double forward_level(const StageRecord& sweep, Index cell) {
  if (status_of(sweep, SweepCheck::forward_double, cell) != SweepStatus::ok)
    return 3;
  switch (status_of(sweep, SweepCheck::forward_single, cell)) {
    case SweepStatus::ok:
      return 0;
    case SweepStatus::inaccurate:
      return 1;
    default:
      return 2;
  }
}

template <class F>
Panel map(const SweepAxis& x,
          const SweepAxis& y,
          const StageRecord& sweep,
          std::string title,
          F&& value) {
  const auto points = static_cast<Index>(x.values.size() * y.values.size());
  const Index examples = cells(sweep) / points;
  Panel panel{.title = std::move(title),
              .x_label = x.label,
              .y_label = y.label,
              .x_log = x.log,
              .y_log = y.log,
              .field = Field2D{.x = x.values, .y = y.values}};
  for (Index p = 0; p < points; ++p) {
    double worst = 0;
    for (Index e = 0; e < examples; ++e)
      worst = std::max(worst, value(p * examples + e));
    panel.field->values.push_back(worst);
  }
  return panel;
}

}  // namespace

std::vector<double> decades(double first, double last, double step) {
  std::vector<double> values;
  for (double e = first; e <= last + step / 2; e += step)
    values.push_back(math::power_of_ten(e));
  return values;
}

std::vector<ProblemRecipe> along(
    const SweepAxis& axis,
    const std::function<ProblemRecipe(double)>& problem) {
  std::vector<ProblemRecipe> all;
  for (const double value : axis.values) all.push_back(problem(value));
  return all;
}

Index sweep_count(const StageRecord& sweep,
                  SweepCheck check,
                  SweepStatus status) {
  Index count = 0;
  for (Index j = 0; j < cells(sweep); ++j)
    count += status_of(sweep, check, j) == status;
  return count;
}

Panel sweep_map(const SweepAxis& x,
                const SweepAxis& y,
                const StageRecord& sweep,
                std::string title) {
  return map(x, y, sweep, std::move(title), [&](Index cell) {
    return forward_level(sweep, cell);
  });
}

const StageRecord* find_sweep(const Evidence& e, const std::string& stage) {
  for (const CaseRecord& c : e.results.cases()) {
    if (c.info.experiment != e.experiment || c.info.method != kStability)
      continue;
    for (const StageRecord& s : c.stages)
      if (s.stage == stage && s.arrays.contains("status")) return &s;
  }
  return nullptr;
}

Table sweep_table(std::string id, std::string title, const StageRecord* sweep) {
  Table table{.id = std::move(id),
              .title = std::move(title),
              .digits = 0,
              .corner = "check",
              .note =
                  "Cells by outcome. Diverged: not finite. Undecided: central "
                  "differences of no step agree, or there is no Jacobian. "
                  "Largest error: of all cells that have one."};
  for (const auto name : kSweepStatusNames) table.columns.emplace_back(name);
  table.columns.emplace_back("largest error");
  for (Index c = 0; c < kSweepChecks; ++c) {
    TableRow row{
        .label = std::string(kSweepCheckNames[static_cast<std::size_t>(c)])};
    for (int s = 0; s < 4; ++s) {
      Cell cell{.text = kNotRun};
      if (sweep != nullptr) {
        const Index n = sweep_count(
            *sweep, static_cast<SweepCheck>(c), static_cast<SweepStatus>(s));
        cell = {.ours = static_cast<double>(n)};
      }
      row.cells.push_back(cell);
    }
    Cell error{.text = kNotRun};
    if (sweep != nullptr) {
      const double largest = sweep->arrays.at("error").row(c).maxCoeff();
      error.text = largest < 0 ? kNothing : fmt::format("{:.1e}", largest);
      if (largest >= 0) error.ours = largest;
    }
    row.cells.push_back(error);
    table.rows.push_back(std::move(row));
  }
  return table;
}

Figure sweep_maps(std::string id,
                  std::string title,
                  const SweepAxis& x,
                  const SweepAxis& y,
                  const StageRecord* sweep) {
  Figure figure{.id = std::move(id),
                .title = std::move(title),
                .note =
                    "Where it runs: 0 fine, 1 float inaccurate, 2 float "
                    "diverged, 3 both diverged. Errors are relative; blank "
                    "cells have none."};
  if (sweep == nullptr) return figure;
  figure.panels.push_back(sweep_map(x, y, *sweep, "Where it runs"));
  for (const auto check : {SweepCheck::forward_single,
                           SweepCheck::adjoint,
                           SweepCheck::adjoint_single}) {
    const auto row = static_cast<Index>(check);
    const auto& error = sweep->arrays.at("error");
    figure.panels.push_back(
        map(x,
            y,
            *sweep,
            "Error: " +
                std::string(kSweepCheckNames[static_cast<std::size_t>(row)]),
            [&](Index cell) {
              const double e = error(row, cell);
              return e < 0 ? 0 : std::max(e, 1e-17);  // blank, or on the scale
            }));
    figure.panels.back().field->log_scale = true;
  }
  return figure;
}

namespace {

/// Cells with a finite double forward pass.
struct AdjointTally {
  double finite = 0, undecided = 0, wrong = 0;
};

void tally(const StageRecord& sweep, AdjointTally& t) {
  for (Index j = 0; j < cells(sweep); ++j) {
    if (status_of(sweep, SweepCheck::forward_double, j) != SweepStatus::ok)
      continue;
    const auto differences = status_of(sweep, SweepCheck::adjoint, j);
    const auto tangent = status_of(sweep, SweepCheck::tangent, j);
    t.finite += 1;
    t.undecided += differences == SweepStatus::undecided;
    for (const auto s : {differences, tangent})
      t.wrong += s == SweepStatus::inaccurate || s == SweepStatus::diverged;
  }
}

/// Over all the sweeps, missing if one of them is.
Quantity total(const std::vector<Select>& sweeps,
               double AdjointTally::*number) {
  return {[=](const Evidence& e) {
            AdjointTally t;
            for (const Select& select : sweeps) {
              const auto runs = find_runs(e, select);
              if (runs.empty()) return missing(select.text() + " not run");
              tally(*runs.front().stage, t);
            }
            return Measured{.value = t.*number,
                            .runs = static_cast<Index>(sweeps.size())};
          },
          sweeps};
}

}  // namespace

Claim adjoint_claim(std::string id, const std::vector<std::string>& stages) {
  std::vector<Select> sweeps;
  for (const std::string& stage : stages) sweeps.push_back({kStability, stage});
  ClaimNames names = claim_names();
  names.set("sweeps", sweeps);
  const auto number = [&](const char* name, double AdjointTally::*of) {
    names.add(name,
              [of](const std::vector<Select>& all) { return total(all, of); });
  };
  number("finite", &AdjointTally::finite);
  number("wrong", &AdjointTally::wrong);
  number("undecided", &AdjointTally::undecided);
  Claim claim = claims_of_folder("numerics/common", names).at(0).claims.at(0);
  claim.id = std::move(id);
  return claim;
}

}  // namespace physinv
