#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "reports/tables.h"
#include "suite/results/csv.h"

namespace physinv {
namespace {

using Cells = std::vector<std::string>;

/// Keys, then quantities.
struct Tidy {
  Cells keys, quantities;
  struct Row {
    Cells keys;
    std::vector<Cell> cells;
  };
  std::vector<Row> rows;
};

Cells keys_of(const Table& table, const TableRow& row) {
  return row.keys.size() == table.keys.size() && !row.keys.empty()
             ? row.keys
             : Cells{row.label};
}

/// As it is: columns are quantities.
Tidy plain(const Table& table) {
  Tidy out{.keys = table.keys, .quantities = table.columns};
  if (out.keys.empty())
    out.keys = {table.corner.empty() ? "row" : table.corner};
  for (const TableRow& row : table.rows) {
    out.rows.push_back({.keys = keys_of(table, row), .cells = {}});
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      out.rows.back().cells.push_back(cell_at(row, c));
  }
  return out;
}

/// A row for each value of the key that columns are of.
Tidy molten(const Table& table) {
  const Tidy wide = plain(table);
  const Cells& values =
      table.across->values.empty() ? table.columns : table.across->values;
  Tidy out{.keys = wide.keys, .quantities = table.across->quantities};
  if (out.quantities.empty()) out.quantities = {"value"};
  out.keys.push_back(table.across->key);
  const std::size_t each = out.quantities.size();
  for (const Tidy::Row& row : wide.rows) {
    for (std::size_t v = 0; v < values.size(); ++v) {
      Tidy::Row one{.keys = row.keys, .cells = {}};
      one.keys.push_back(values[v]);
      for (std::size_t q = 0; q < each; ++q)
        one.cells.push_back(
            cell_at({.label = {}, .cells = row.cells}, v * each + q));
      out.rows.push_back(std::move(one));
    }
  }
  return out;
}

/// A column of the file.
struct Column {
  std::string head;
  std::function<std::string(const Tidy::Row&)> cell;
};

/// Cells that stand for a number which is not there.
std::string note_of(const Cell& cell) {
  return cell.ours || cell.text == "–" ? "" : csv_text(cell.text);
}

std::vector<Column> columns_of(const Tidy& table, const std::string& unit) {
  std::vector<Column> columns;
  for (std::size_t k = 0; k < table.keys.size(); ++k)
    columns.push_back({table.keys[k], [k](const Tidy::Row& row) {
                         return csv_text(row.keys[k]);
                       }});
  const auto any = [&](std::size_t q, auto&& text) {
    return std::any_of(
        table.rows.begin(), table.rows.end(), [&](const auto& r) {
          return !text(r.cells[q]).empty();
        });
  };
  for (std::size_t q = 0; q < table.quantities.size(); ++q) {
    const std::string& name = table.quantities[q];
    const auto add = [&](std::string head, auto text, bool always = false) {
      if (always || any(q, text))
        columns.push_back({std::move(head), [q, text](const Tidy::Row& row) {
                             return text(row.cells[q]);
                           }});
    };
    const auto number = [&](const char* what,
                            std::optional<double> Cell::*member,
                            bool always = false) {
      add(
          fmt::format("{}{}{}",
                      name,
                      what,
                      unit.empty() ? "" : fmt::format(" [{}]", unit)),
          [member](const Cell& cell) { return csv_number(cell.*member); },
          always);
    };
    const bool words = any(q, note_of) && !any(q, [](const Cell& cell) {
                         return csv_number(cell.ours) + csv_number(cell.paper);
                       });
    if (!words) number("", &Cell::ours, true);
    number(" spread", &Cell::spread);
    number(" paper", &Cell::paper);
    number(" paper spread", &Cell::paper_spread);
    add(name + " of", [](const Cell& cell) { return csv_text(cell.of); });
    add(words ? name : name + " note", note_of);
  }
  return columns;
}

}  // namespace

std::string to_csv(const Table& table) {
  const Tidy tidy = table.across ? molten(table) : plain(table);
  const auto columns = columns_of(tidy, table.unit);
  std::string out;
  for (const Column& column : columns)
    out += (out.empty() ? "" : ",") + csv_text(column.head);
  for (const Tidy::Row& row : tidy.rows) {
    const char* before = "\n";
    for (const Column& column : columns) {
      out += before + column.cell(row);
      before = ",";
    }
  }
  return out + "\n";
}

std::string to_csv(const Figure& figure) {
  std::string out = "panel,series,x,y,from,to,value\n";
  for (const Panel& panel : figure.panels) {
    for (const Series& s : panel.series)
      for (std::size_t k = 0; k < std::min(s.x.size(), s.y.size()); ++k) {
        const auto end = [&](const std::vector<double>& ends) {
          return k < ends.size() ? std::optional(ends[k]) : std::nullopt;
        };
        out += fmt::format("{},{},{},{},{},{},\n",
                           csv_text(panel.title),
                           csv_text(s.label.empty() ? s.method : s.label),
                           csv_number(s.x[k]),
                           csv_number(s.y[k]),
                           csv_number(end(s.lo)),
                           csv_number(end(s.hi)));
      }
    if (!panel.field) continue;
    const Field2D& f = *panel.field;
    for (std::size_t k = 0; k < f.values.size(); ++k) {
      const std::size_t i = k % f.x.size(), j = k / f.x.size();
      out += fmt::format(
          "{},,{},{},,,{}\n",
          csv_text(panel.title),
          f.x_names.empty() ? csv_number(f.x[i]) : csv_text(f.x_names[i]),
          f.y_names.empty() ? csv_number(f.y[j]) : csv_text(f.y_names[j]),
          csv_number(f.values[k]));
    }
  }
  return out;
}

}  // namespace physinv
