#include "reports/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "reports/text.h"
#include "suite/results/markdown.h"
#include "suite/results/shortened.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;
using Number = std::optional<double>;

// A rectangle of words; the first line heads it, the first column labels it.
using Words = std::vector<std::vector<std::string>>;

bool has_paper(const Table& table, std::size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(), [&](const auto& r) {
    return cell_at(r, column).paper.has_value();
  });
}

std::string show(Number value, Number spread, int digits) {
  if (!value) return "";
  std::string text = show_number(*value, digits);
  if (spread) text += " ± " + show_number(*spread, digits);
  return text;
}

std::string ours(const Cell& cell, int digits) {
  if (!cell.text.empty()) return cell.text;
  return cell.ours ? show(cell.ours, cell.spread, digits) : "–";
}

// Its words as `shown` writes them.
template <class F>
std::string headline(const Table& table, F&& shown) {
  std::string text = shown(table.where);
  if (!text.empty() && !table.title.empty()) text += " · ";
  text += shown(table.title);
  return table.unit.empty() ? text
                            : fmt::format("{} [{}]", text, shown(table.unit));
}

// Control characters would move a terminal's cursor.
std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return text;
}

Words words_of(const Table& table) {
  Words words{{table.corner}};
  for (const TableRow& row : table.rows) words.push_back({row.label});
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const bool paper = has_paper(table, c);
    words[0].push_back(table.columns[c]);
    if (paper) words[0].emplace_back("paper");
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
      const Cell& cell = cell_at(table.rows[r], c);
      words[r + 1].push_back(ours(cell, table.digits));
      if (paper) {
        words[r + 1].push_back(
            show(cell.paper, cell.paper_spread, table.digits));
      }
    }
  }
  for (auto& line : words)
    for (std::string& word : line) word = printable(std::move(word));
  return words;
}

std::vector<std::size_t> widths_of(const Words& words, std::size_t least) {
  std::vector<std::size_t> widths(words[0].size(), least);
  for (const auto& line : words) {
    for (std::size_t c = 0; c < line.size(); ++c) {
      widths[c] = std::max(widths[c], display_width(line[c]));
    }
  }
  return widths;
}

std::string aligned(const std::string& word, std::size_t width, bool label) {
  return label ? pad_right(word, width) : pad_left(word, width);
}

// A column and the paper's next to it stay together.
std::vector<std::size_t> block_starts(const Words& words,
                                      const std::vector<std::size_t>& widths,
                                      std::size_t width) {
  std::vector<std::size_t> starts;
  std::size_t used = 0;
  const std::size_t columns = words[0].size();
  for (std::size_t c = 1; c < columns;) {
    const bool pair = c + 1 < columns && words[0][c + 1] == "paper";
    const std::size_t need = 2 + widths[c] + (pair ? 2 + widths[c + 1] : 0);
    if (starts.empty() || used + need > width) {
      starts.push_back(c);
      used = widths[0];
    }
    used += need;
    c += pair ? 2 : 1;
  }
  starts.push_back(columns);
  return starts;
}

}  // namespace

const Cell& cell_at(const TableRow& row, std::size_t column) {
  static const Cell kNone;
  return column < row.cells.size() ? row.cells[column] : kNone;
}

nlohmann::ordered_json to_json(const Table& table) {
  const auto number = [](Number v) {
    return v && std::isfinite(*v) ? Json(*v) : Json(nullptr);
  };
  Json out{{"id", table.id},
           {"title", table.title},
           {"source", table.where},
           {"unit", table.unit},
           {"corner", table.corner},
           {"columns", table.columns},
           {"rows", Json::array()},
           {"note", table.note}};
  for (const TableRow& row : table.rows) {
    Json cells = Json::array();
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const Cell& cell = cell_at(row, c);
      Json one{{"ours", number(cell.ours)},
               {"spread", number(cell.spread)},
               {"paper", number(cell.paper)},
               {"paper_spread", number(cell.paper_spread)}};
      if (!cell.text.empty()) one["text"] = cell.text;
      cells.push_back(std::move(one));
    }
    out["rows"].push_back({{"label", row.label}, {"cells", std::move(cells)}});
  }
  return out;
}

std::string to_markdown(const Table& table) {
  Words words = words_of(table);
  for (auto& line : words) {
    for (std::string& word : line) word = markdown(word);
  }
  const auto widths = widths_of(words, 3);
  std::string out = fmt::format("**{}**\n\n", headline(table, markdown));
  for (std::size_t r = 0; r < words.size(); ++r) {
    for (std::size_t c = 0; c < words[r].size(); ++c) {
      out += "| " + aligned(words[r][c], widths[c], c == 0) + ' ';
    }
    out += "|\n";
    if (r > 0) continue;
    for (std::size_t c = 0; c < widths.size(); ++c) {
      const std::string rule(widths[c], '-');
      out += c == 0 ? "| " + rule + ' ' : "| " + rule.substr(1) + ": ";
    }
    out += "|\n";
  }
  if (!table.note.empty()) out += '\n' + markdown(table.note) + '\n';
  return out;
}

namespace {

// A label leaves half of the room to its row, and so does a word.
void shorten(Words& words, std::size_t width) {
  constexpr std::size_t kLeast = 12;
  const std::size_t most = std::max(kLeast, width / 2 - 1);
  for (auto& line : words)
    for (std::string& word : line) word = shortened(word, most);
}

}  // namespace

std::string render_text(const Table& table, std::size_t width) {
  Words words = words_of(table);
  shorten(words, width);
  const auto widths = widths_of(words, 1);
  const auto starts = block_starts(words, widths, width);
  std::string out;
  for (const std::string& line : wrap(headline(table, printable), width)) {
    out += line + '\n';
  }
  for (std::size_t b = 0; b + 1 < starts.size(); ++b) {
    if (b > 0) out += '\n';
    for (std::size_t r = 0; r < words.size(); ++r) {
      std::string line = pad_right(words[r][0], widths[0]);
      for (std::size_t c = starts[b]; c < starts[b + 1]; ++c) {
        line += "  " + pad_left(words[r][c], widths[c]);
      }
      out += line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
      if (r == 0) {
        std::string rule;
        for (std::size_t i = 0; i < display_width(line); ++i) rule += "─";
        out += rule + '\n';
      }
    }
  }
  for (const std::string& line : wrap(printable(table.note), width))
    out += line + '\n';
  return out;
}

}  // namespace physinv
