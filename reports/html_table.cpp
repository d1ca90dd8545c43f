#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <regex>
#include <vector>

#include "reports/html_parts.h"
#include "reports/tables.h"
#include "reports/text.h"

namespace physinv {
namespace {

using Number = std::optional<double>;
constexpr std::size_t kFlatRows = 2, kWideColumns = 4;
constexpr std::string_view kSpread = " ± ";
constexpr auto npos = std::string::npos;

// What columns of words one column of the table has.
struct Layout {
  bool spread = false, paper = false, paper_spread = false;
  int ours_width() const { return 1 + spread; }
  int paper_width() const { return paper ? 1 + paper_spread : 0; }
};

Layout layout_of(const Table& table, std::size_t column) {
  Layout layout;
  for (const TableRow& row : table.rows) {
    const Cell& cell = cell_at(row, column);
    layout.spread |= cell.text.empty() ? cell.spread.has_value()
                                       : cell.text.find(kSpread) != npos;
    layout.paper |= cell.paper.has_value();
    layout.paper_spread |= cell.paper && cell.paper_spread;
  }
  return layout;
}

Table turned(const Table& table) {
  Table out = table;
  out.columns.clear();
  out.rows.clear();
  for (const TableRow& row : table.rows) out.columns.push_back(row.label);
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    TableRow line{.label = table.columns[c]};
    for (const TableRow& row : table.rows)
      line.cells.push_back(cell_at(row, c));
    out.rows.push_back(std::move(line));
  }
  return out;
}

bool is_missing(const Cell& cell) {
  return cell.text == "not run" && !cell.paper;
}

// Without columns and rows of which nothing was run; `words` names them.
Table without_missing(const Table& table, std::string& words) {
  Table out = table;
  std::vector<std::string> missing;
  out.columns.clear();
  for (TableRow& row : out.rows) row.cells.clear();
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const bool all =
        !table.rows.empty() &&
        std::all_of(
            table.rows.begin(), table.rows.end(), [&](const TableRow& row) {
              return is_missing(cell_at(row, c));
            });
    if (all) {
      missing.push_back(table.columns[c]);
      continue;
    }
    out.columns.push_back(table.columns[c]);
    for (std::size_t r = 0; r < table.rows.size(); ++r)
      out.rows[r].cells.push_back(cell_at(table.rows[r], c));
  }
  std::erase_if(out.rows, [&](const TableRow& row) {
    const bool all =
        !row.cells.empty() &&
        std::all_of(row.cells.begin(), row.cells.end(), is_missing);
    if (all) missing.push_back(row.label);
    return all;
  });
  if (!missing.empty() && !out.rows.empty() && !out.columns.empty())
    words = nil_html(fmt::format("not run: {}", fmt::join(missing, "; ")));
  return out;
}

// 2.2e-04 reads 2.2·10⁻⁴.
std::string powers_of_ten(const std::string& text) {
  static const std::regex kPower("([0-9])e([+-]?[0-9]{1,3})(?![0-9])");
  std::string out;
  auto rest = text.begin();
  for (std::sregex_iterator at(text.begin(), text.end(), kPower), end;
       at != end;
       ++at) {
    out.append(rest, (*at)[1].second);
    out += "·10" + superscript(std::stoi((*at)[2]));
    rest = (*at)[0].second;
  }
  return out.append(rest, text.end());
}

std::string number_html(double value, int digits) {
  return powers_of_ten(show_number(value, digits));
}

std::string span(std::string_view name, int count) {
  return count > 1 ? fmt::format(" {}=\"{}\"", name, count) : "";
}

std::string cells_html(
    Number value, Number spread, int digits, int width, std::string_view css) {
  std::string out = fmt::format(
      "<td{}>{}</td>", css, value ? number_html(*value, digits) : "–");
  if (width < 2) return out;
  return out + fmt::format(
                   "<td class=\"spread\">{}</td>",
                   value && spread ? "± " + number_html(*spread, digits) : "");
}

// Words instead of numbers, or numbers the experiment has set itself.
std::string text_html(const std::string& text, int width) {
  const std::size_t at = text.find(kSpread);
  const bool number = text.find_first_of("0123456789") == 0;
  if (at == npos || width < 2) {
    return fmt::format("<td{}{}>{}</td>",
                       number ? "" : " class=\"nil\"",
                       number ? "" : span("colspan", width),
                       powers_of_ten(html(text))) +
           (number && width > 1 ? "<td class=\"spread\"></td>" : "");
  }
  return fmt::format("<td>{}</td><td class=\"spread\">{}</td>",
                     powers_of_ten(html(text.substr(0, at))),
                     powers_of_ten(html(text.substr(at + 1))));
}

std::string cell_html(const Cell& cell, const Layout& layout, int digits) {
  std::string out =
      cell.text.empty()
          ? cells_html(cell.ours, cell.spread, digits, layout.ours_width(), "")
          : text_html(cell.text, layout.ours_width());
  if (!layout.paper) return out;
  if (!cell.paper) {
    return out +
           fmt::format("<td{}></td>", span("colspan", layout.paper_width()));
  }
  return out + cells_html(cell.paper,
                          cell.paper_spread,
                          digits,
                          layout.paper_width(),
                          " class=\"paper\"");
}

std::string head_html(const Table& table, const std::vector<Layout>& layouts) {
  const bool papers = std::any_of(
      layouts.begin(), layouts.end(), [](const Layout& l) { return l.paper; });
  std::string out =
      fmt::format("<tr><th scope=\"col\"{}>{}</th>",
                  papers ? " rowspan=\"2\"" : "",
                  table.corner.empty() ? "<span class=\"hidden\">row</span>"
                                       : html(table.corner));
  std::string second = "<tr>";
  for (std::size_t c = 0; c < layouts.size(); ++c) {
    const Layout& l = layouts[c];
    const int width = l.ours_width() + l.paper_width();
    out += fmt::format("<th scope=\"{}\"{}>{}</th>",
                       width > 1 ? "colgroup" : "col",
                       span("colspan", width),
                       html(table.columns[c]));
    second += fmt::format("<th scope=\"col\"{}>here</th>",
                          span("colspan", l.ours_width()));
    if (l.paper) {
      second += fmt::format("<th scope=\"col\" class=\"paper\"{}>paper</th>",
                            span("colspan", l.paper_width()));
    }
  }
  out += "</tr>\n";
  return papers ? out + second + "</tr>\n" : out;
}

}  // namespace

std::string table_html(const Table& given, const std::string& id) {
  std::string missing;
  const Table run = without_missing(given, missing);
  const bool flat =
      run.rows.size() <= kFlatRows && run.columns.size() >= kWideColumns;
  const Table table = flat ? turned(run) : run;
  std::vector<Layout> layouts;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    layouts.push_back(layout_of(table, c));
  }
  const std::string title =
      table.unit.empty() ? table.title
                         : fmt::format("{} [{}]", table.title, table.unit);
  std::string out = fmt::format(
      "<div class=\"table\" id=\"{0}\">\n"
      "<p class=\"caption\" id=\"{0}-caption\">{1}</p>\n",
      id,
      caption_html(id, table.where, title));
  if (table.rows.empty() || table.columns.empty())
    return out + nil_html("not run") + "</div>\n";
  out += fmt::format(
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
      "aria-labelledby=\"{0}-caption\">\n"
      "<table aria-labelledby=\"{0}-caption\">\n<thead>\n{1}</thead>\n"
      "<tbody>\n",
      id,
      head_html(table, layouts));
  for (const TableRow& row : table.rows) {
    out += fmt::format("<tr><th scope=\"row\">{}</th>", html(row.label));
    for (std::size_t c = 0; c < layouts.size(); ++c) {
      out += cell_html(cell_at(row, c), layouts[c], table.digits);
    }
    out += "</tr>\n";
  }
  out += "</tbody>\n</table>\n</div>\n" + missing;
  if (!table.note.empty()) {
    out += fmt::format("<p class=\"remark\">{}</p>\n", html(table.note));
  }
  return out + "</div>\n";
}

}  // namespace physinv
