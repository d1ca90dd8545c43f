/// Tables of a digest: {where, title, unit, digits, corner, columns, rows,
/// note}. A row is [label, cell, ...]; a cell is null, a text or an object with
/// those of {ours, spread, paper, paper_spread, text} that the cell has.
#pragma once

#include <nlohmann/json.hpp>

#include "suite/results/report_model.h"

namespace physinv {

nlohmann::ordered_json table_json(const Table& table);
/// Throws a JSON error or std::runtime_error if it is not a table. It has no
/// id.
Table table_from(const nlohmann::ordered_json& table);

}  // namespace physinv
