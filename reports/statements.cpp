#include "reports/statements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/tables.h"
#include "reports/text.h"

namespace physinv {

const ConditionResult* telling(const ClaimResult& c) {
  const auto at = std::find_if(
      c.conditions.begin(), c.conditions.end(), [](const auto& condition) {
        return condition.holds && !*condition.holds;
      });
  if (at != c.conditions.end()) return &*at;
  const auto bound = std::find_if(
      c.conditions.begin(), c.conditions.end(), [](const auto& condition) {
        return condition.value && !condition.bounds.empty();
      });
  return bound == c.conditions.end() ? nullptr : &*bound;
}

namespace {

bool is_decided(const ClaimResult& c) {
  return c.verdict != Verdict::not_judged && c.verdict != Verdict::reported;
}

Statement statement_of(const ClaimResult& c) {
  Statement f{.what = c.id + " " + c.says,
              .here = {},
              .paper = {},
              .verdict = c.verdict,
              .origin = c.origin};
  if (const ConditionResult* condition = telling(c)) {
    if (condition->value) f.here = value_text(*condition->value);
    f.paper = condition->label + ' ' + condition->bounds;
  }
  return f;
}

/// Decided claims of an origin, failing ones first.
void add_claims(std::vector<Statement>& all,
                const Section& section,
                Origin origin,
                bool failing_only) {
  for (const bool holds : {false, true})
    for (const ClaimResult& c : section.claims)
      if (c.origin == origin && is_decided(c) &&
          (c.verdict == Verdict::reproduced) == holds &&
          !(holds && failing_only))
        all.push_back(statement_of(c));
}

bool is_of_times(const Table& table) {
  return table.unit == "s" || table.unit.ends_with(" s");
}

std::string number(const std::optional<double>& value,
                   const std::optional<double>& spread,
                   const Table& table) {
  std::string text = show_number(*value, table.digits);
  if (spread) text += " ± " + show_number(*spread, table.digits);
  return table.unit.empty() ? text : text + " " + table.unit;
}

/// Cells with both numbers. A row of the experiment as a whole has no name.
std::vector<Statement> cells_of(const Table& table, const std::string& title) {
  std::vector<Statement> cells;
  for (const TableRow& row : table.rows) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const Cell& cell = cell_at(row, c);
      if (!cell.ours || !cell.paper || !cell.text.empty()) continue;
      cells.push_back(
          {.what = fmt::format("{}: {}{}{}",
                               table.where.empty() ? table.title : table.where,
                               table.columns[c],
                               row.label == title ? "" : ", ",
                               row.label == title ? "" : row.label),
           .here = number(cell.ours, cell.spread, table),
           .paper = number(cell.paper, cell.paper_spread, table)});
    }
  }
  return cells;
}

void add_cells(std::vector<Statement>& all,
               const Section& section,
               std::size_t most) {
  std::vector<std::vector<Statement>> tables;
  for (const Table& table : section.tables)
    if (!is_of_times(table)) tables.push_back(cells_of(table, section.title));
  for (std::size_t k = 0; all.size() < most; ++k) {
    bool any = false;
    for (const auto& cells : tables) {
      if (k >= cells.size()) continue;
      any = true;
      if (all.size() < most) all.push_back(cells[k]);
    }
    if (!any) return;
  }
}

}  // namespace

std::string value_text(double value) {
  constexpr double kCounts = 1e6;
  return value == std::round(value) && std::abs(value) < kCounts
             ? fmt::format("{:.0f}", value)
             : fmt::format("{:.3g}", value);
}

std::vector<Statement> statements_of(const Section& section, std::size_t most) {
  std::vector<Statement> all;
  add_claims(all, section, Origin::paper, false);
  add_claims(all, section, Origin::suite, true);
  if (all.size() < most) add_cells(all, section, most);
  all.resize(std::min(all.size(), most));
  return all;
}

}  // namespace physinv
