#include "reports/digest_tables.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "reports/tables.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kNumbers = {
    std::pair("ours", &Cell::ours),
    std::pair("spread", &Cell::spread),
    std::pair("paper", &Cell::paper),
    std::pair("paper_spread", &Cell::paper_spread)};

/// A number that is not finite is left out, as JSON has none.
Json cell_json(const Cell& cell) {
  Json out = Json::object();
  for (const auto& [key, number] : kNumbers)
    if (const auto& value = cell.*number; value && std::isfinite(*value))
      out[key] = *value;
  if (!cell.text.empty()) out["text"] = cell.text;
  if (out.empty()) return nullptr;
  return out.size() == 1 && !cell.text.empty() ? Json(cell.text) : out;
}

Cell cell_from(const Json& cell) {
  if (cell.is_null()) return {};
  if (cell.is_string()) return {.text = cell};
  Cell out{.text = cell.value("text", "")};
  for (const auto& [key, number] : kNumbers)
    if (cell.contains(key)) out.*number = cell[key].get<double>();
  return out;
}

}  // namespace

Json table_json(const Table& table) {
  Json rows = Json::array();
  for (const TableRow& row : table.rows) {
    Json line{row.label};
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      line.push_back(cell_json(cell_at(row, c)));
    rows.push_back(std::move(line));
  }
  return {{"where", table.where},
          {"title", table.title},
          {"unit", table.unit},
          {"digits", table.digits},
          {"corner", table.corner},
          {"columns", table.columns},
          {"rows", std::move(rows)},
          {"note", table.note}};
}

Table table_from(const Json& table) {
  Table out{.id = {},
            .title = table.at("title"),
            .where = table.at("where"),
            .unit = table.at("unit"),
            .digits = table.at("digits"),
            .corner = table.at("corner"),
            .columns = table.at("columns"),
            .rows = {},
            .note = table.at("note")};
  for (const Json& line : table.at("rows")) {
    if (line.size() != out.columns.size() + 1)
      throw std::runtime_error("a row of a table has other columns");
    TableRow row{line.at(0), {}};
    for (std::size_t c = 1; c < line.size(); ++c)
      row.cells.push_back(cell_from(line[c]));
    out.rows.push_back(std::move(row));
  }
  return out;
}

}  // namespace physinv
