/// Tables of the report model as JSON, CSV, Markdown and terminal text.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "suite/results/report_model.h"

namespace physinv {

/// The cell of a column; an empty one where the row is shorter.
const Cell& cell_at(const TableRow& row, std::size_t column);

/// {id, title, source, unit, corner, columns, rows: [{label, cells: [{ours,
/// spread, paper, paper_spread}]}], note}; null where a number is absent or
/// not finite, `text` only where a cell has one.
nlohmann::ordered_json to_json(const Table& table);

/// Tidy: the keys of a row in separate columns (`Table::keys`, else the corner;
/// `Table::across`), one value a cell, the unit in the head, numbers with every
/// digit, empty where there is none. A column has others next to it where any
/// row has that: "spread", "paper", "paper spread", "of" and, for words in the
/// place of a number, "note".
std::string to_csv(const Table& table);

/// A figure's points, a line each: panel, series, x, y and the ends of its
/// band; of a field each cell, its value behind them.
std::string to_csv(const Figure& figure);

/// Aligned pipe table with title and note: ours ± spread, and a column "paper"
/// next to it where the paper printed any.
std::string to_markdown(const Table& table);

/// The same for a terminal. Columns that do not fit into `width` continue
/// below, with the labels repeated.
std::string render_text(const Table& table, std::size_t width);

}  // namespace physinv
