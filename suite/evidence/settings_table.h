/// Tables of a study: what comes out with each setting.
#pragma once

#include <utility>

#include "suite/results/report_model.h"

namespace physinv {

/// `table` with a column for each of `columns` (which have titles) and a row
/// for each setting, called title(setting), of cells cell(setting, column).
template <class Settings, class Columns, class Title, class CellOf>
Table table_by_setting(Table table,
                       const Settings& settings,
                       const Columns& columns,
                       Title&& title,
                       CellOf&& cell) {
  for (const auto& c : columns) table.columns.push_back(c.title);
  for (const auto& s : settings) {
    TableRow row{.label = title(s)};
    for (const auto& c : columns) row.cells.push_back(cell(s, c));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace physinv
