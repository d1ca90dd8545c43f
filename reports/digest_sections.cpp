#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "reports/anchors.h"
#include "reports/digest.h"
#include "reports/report.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

/// The text that suite/results/markdown.h wrote.
std::string unmarked(std::string_view text) {
  constexpr std::string_view kLess = "&lt;", kAnd = "&amp;";
  std::string out;
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (text.substr(k).starts_with(kLess)) {
      out += '<';
      k += kLess.size() - 1;
    } else if (text.substr(k).starts_with(kAnd)) {
      out += '&';
      k += kAnd.size() - 1;
    } else if (text[k] == '\\' && k + 1 < text.size()) {
      out += text[++k];
    } else {
      out += text[k];
    }
  }
  return out;
}

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(' ');
  if (begin == text.npos) return "";
  return text.substr(begin, text.find_last_not_of(' ') + 1 - begin);
}

/// The words of "| a | b |".
std::vector<std::string> words_in(std::string_view line) {
  std::vector<std::string> words;
  std::size_t begin = 1;
  for (std::size_t k = 1; k < line.size(); ++k) {
    if (line[k] == '\\') {
      ++k;
    } else if (line[k] == '|') {
      words.push_back(unmarked(trimmed(line.substr(begin, k - begin))));
      begin = k + 1;
    }
  }
  return words;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  for (std::size_t at = 0; at < text.size();) {
    const auto end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

/// "Table 2 · Title [%]": where it stands in the paper, what it is in.
void set_title(Table& table, std::string_view line) {
  table.title = unmarked(line);
  constexpr std::string_view kBetween = " · ";
  if (const auto at = table.title.find(kBetween);
      at != std::string::npos &&
      !places_of(table.title.substr(0, at)).empty()) {
    table.where = table.title.substr(0, at);
    table.title.erase(0, at + kBetween.size());
  }
  if (const auto at = table.title.rfind(" [");
      at != std::string::npos && table.title.ends_with(']')) {
    table.unit = table.title.substr(at + 2, table.title.size() - at - 3);
    table.title.resize(at);
  }
}

Section section_of(const Json& digest) {
  Section section{.experiment = digest.at("experiment"),
                  .title = digest.at("title"),
                  .paper = digest.at("paper")};
  section.standing = digest.value("standing", "");
  for (const Json& claim : digest.at("claims"))
    section.claims.push_back(claim_from(claim));
  for (const Json& table : digest.at("tables"))
    section.tables.push_back(
        table_of(table.get<std::string>(),
                 fmt::format("table-{}", section.tables.size() + 1)));
  return section;
}

}  // namespace

Table table_of(const std::string& markdown, std::string id) {
  Table table{.id = std::move(id)};
  bool headed = false;
  for (const std::string_view line : lines_of(markdown)) {
    if (line.starts_with("| -") || line.empty()) continue;
    if (line.starts_with("|")) {
      auto words = words_in(line);
      if (words.empty()) continue;
      if (!headed) {
        table.corner = words.front();
        table.columns.assign(words.begin() + 1, words.end());
        headed = true;
        continue;
      }
      TableRow row{words.front(), {}};
      for (std::size_t k = 1; k < words.size(); ++k)
        row.cells.push_back({.text = std::move(words[k])});
      table.rows.push_back(std::move(row));
    } else if (line.size() > 4 && line.starts_with("**") && !headed) {
      set_title(table, line.substr(2, line.size() - 4));
    } else {
      table.note += (table.note.empty() ? "" : " ") + unmarked(line);
    }
  }
  if (!headed) throw std::runtime_error("a table of the digest has no head");
  return table;
}

std::vector<Section> sections_of(const Json& digest) {
  std::vector<Section> sections;
  for (const Json& section : digest.at("sections"))
    sections.push_back(section_of(section));
  return sections;
}

std::vector<Section> sections_of(const NamedDigest& campaign) {
  std::vector<Section> sections = sections_of(campaign.digest);
  for (Section& s : sections)
    if (const auto at = campaign.work.find(s.experiment);
        at != campaign.work.end())
      s.work = at->second;
  return sections;
}

}  // namespace physinv
