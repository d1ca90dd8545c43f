#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string>

#include "suite/cases/numerics/half_inverse/sweep.h"
#include "suite/evidence/cell.h"
#include "suite/harness/registry.h"

namespace physinv::half_inverse_numerics {
namespace {

constexpr const char* kPaths[] = {
    "Cholesky", "tridiagonal", "two-level", "SVD of J"};

using Choice = std::function<bool(Index cell)>;

/// Cells by how they ended, and the largest update over its bound.
TableRow ends(const Cells& cells, std::string label, const Choice& chosen) {
  double counts[4] = {}, largest = -1;
  for (Index j = 0; j < cells.count(); ++j) {
    if (!chosen(j)) continue;
    ++counts[static_cast<int>(cells.status(j))];
    largest = std::max(largest, cells.get("size", j));
  }
  TableRow row{.label = std::move(label)};
  for (const double n : counts) row.cells.push_back({.ours = n});
  row.cells.push_back(
      {.text = largest < 0 ? kNothing : fmt::format("{:.3g}", largest)});
  return row;
}

Table ends_table(const StageRecord* stage) {
  Table table{.id = "ends",
              .title = "How the combinations end",
              .digits = 0,
              .corner = "of",
              .note =
                  "Unproven: an update's error estimate exceeds 3e-4, or rests "
                  "on singular values that rounding could have made. Last "
                  "column: largest |update| / (s^kappa |g|), s the smallest "
                  "singular value kept."};
  for (const auto name : kStressStatusNames) table.columns.emplace_back(name);
  table.columns.emplace_back("update / bound");
  if (stage == nullptr) return table;
  const Cells cells(*stage);
  const auto add =
      [&](const std::string& label, StressAxis axis, std::size_t at) {
        table.rows.push_back(ends(cells, label, [&](Index j) {
          return cells.on(axis, j) == static_cast<Index>(at);
        }));
      };
  for (std::size_t i = 0; i < kStarts.size(); ++i)
    add("weights " + kStarts[i].name, StressAxis::start, i);
  for (std::size_t i = 0; i < kTaus.size(); ++i)
    add(fmt::format("tau = {:g}", kTaus[i]), StressAxis::tau, i);
  for (std::size_t i = 0; i < kGammas.size(); ++i)
    add(fmt::format("gamma = {:g}", kGammas[i]), StressAxis::problem, i);
  for (std::size_t i = 0; i < kKappas.size(); ++i)
    add(fmt::format("kappa = {:g}", kKappas[i]), StressAxis::kappa, i);
  add("each sample once", StressAxis::copies, 0);
  add("each sample twice", StressAxis::copies, 1);
  add("float", StressAxis::precision, 0);
  add("double", StressAxis::precision, 1);
  for (std::size_t i = 0; i < std::size(kPaths); ++i)
    table.rows.push_back(
        ends(cells, fmt::format("path {}", kPaths[i]), [&](Index j) {
          return cells.get("path", j) == static_cast<double>(i);
        }));
  return table;
}

/// A value over gamma and tau, the worst of the chosen cells.
Panel map(const Cells& cells,
          std::string title,
          const Choice& chosen,
          const std::function<double(Index)>& value) {
  Panel panel{.title = std::move(title),
              .x_label = "gamma",
              .y_label = "tau (lowest: 0)",
              .x_log = true,
              .y_log = true,
              .field = Field2D{}};
  Field2D& field = *panel.field;
  field.x.assign(kGammas.rbegin(), kGammas.rend());
  for (const double tau : kTaus)
    field.y.push_back(tau > 0 ? tau : 1e-2 * kTaus[1]);
  field.values.assign(kGammas.size() * kTaus.size(), 0.0);
  for (Index j = 0; j < cells.count(); ++j) {
    if (!chosen(j)) continue;
    const auto g = kGammas.size() - 1 -
                   static_cast<std::size_t>(cells.on(StressAxis::problem, j));
    const auto t = static_cast<std::size_t>(cells.on(StressAxis::tau, j));
    double& worst = field.values[t * kGammas.size() + g];
    worst = std::max(worst, value(j));
  }
  return panel;
}

Figure maps(const StageRecord* stage) {
  Figure figure{.id = "maps",
                .title = "Half-inverse updates over gamma and tau",
                .note =
                    "Ends: 0 ok, 1 zero, 2 unproven, 3 not finite; the worst "
                    "of all starts with J other than 0. Kept: of 8 singular "
                    "values in double, weights as drawn, kappa -1/2."};
  if (stage == nullptr) return figure;
  const Cells cells(*stage);
  for (const Index precision : {0, 1})
    for (const Index copies : {0, 1})
      figure.panels.push_back(map(
          cells,
          fmt::format("Ends: {}, each sample {}",
                      precision == 0 ? "float" : "double",
                      copies == 0 ? "once" : "twice"),
          [&](Index j) {
            return !cells.blind(j) &&
                   cells.on(StressAxis::precision, j) == precision &&
                   cells.on(StressAxis::copies, j) == copies;
          },
          [&](Index j) { return cells.get("status", j); }));
  for (const Index copies : {0, 1})
    figure.panels.push_back(map(
        cells,
        fmt::format("Kept: {} samples, each {}",
                    kSamples[0],
                    copies == 0 ? "once" : "twice"),
        [&](Index j) {
          return cells.on(StressAxis::start, j) == 0 &&
                 cells.on(StressAxis::samples, j) == 0 &&
                 cells.on(StressAxis::kappa, j) == 0 &&
                 cells.on(StressAxis::precision, j) == 1 &&
                 cells.on(StressAxis::copies, j) == copies;
        },
        [&](Index j) { return cells.get("kept", j); }));
  return figure;
}

/// Loss after the updates and norm of the largest, over gamma.
Figure lines(const StageRecord* stage) {
  Figure figure{.id = "lines",
                .title = "What a few updates do",
                .note =
                    "Three updates at rate 1 in double, tau 1e-6, 20 samples. "
                    "Updates: the largest of them."};
  if (stage == nullptr) return figure;
  const Cells cells(*stage);
  const auto panel = [&](const char* label, ArrayKey array, Index row) {
    Panel out{
        .x_label = "gamma", .y_label = label, .x_log = true, .y_log = true};
    for (std::size_t k = 0; k < kKappas.size(); ++k)
      for (std::size_t s = 0; s < 3; ++s) {
        Series series{
            .label = fmt::format(
                "kappa {:g}, weights {}", kKappas[k], kStarts[s].name),
            .method = fmt::format("{}-{}", k, s),
            .markers = true,
            .dashed = k == 1};
        for (Index j = 0; j < cells.count(); ++j) {
          const double value = cells.get(array, j, row);
          if (cells.on(StressAxis::kappa, j) == Index(k) &&
              cells.on(StressAxis::start, j) == Index(s) &&
              cells.on(StressAxis::samples, j) == 1 &&
              cells.on(StressAxis::tau, j) == 2 &&
              cells.on(StressAxis::copies, j) == 0 &&
              cells.on(StressAxis::precision, j) == 1 && value > 0) {
            series.x.push_back(kGammas[static_cast<std::size_t>(
                cells.on(StressAxis::problem, j))]);
            series.y.push_back(value);
          }
        }
        out.series.push_back(std::move(series));
      }
    return out;
  };
  figure.panels = {panel("loss after the updates", "loss", 1),
                   panel("|update|", "norm", 0)};
  return figure;
}

Section report(const Evidence& e) {
  const auto run = first_run(e, {kMethod});
  const StageRecord* stage = run ? run->stage : nullptr;
  return {.tables = {ends_table(stage)},
          .figures = {maps(stage), lines(stage)}};
}

}  // namespace

void add_reports(Registry& r) { r.add_report(kName, report); }

}  // namespace physinv::half_inverse_numerics
