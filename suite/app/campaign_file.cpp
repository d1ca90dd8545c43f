#include "suite/app/campaign_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "suite/harness/errors.h"
#include "suite/store/file.h"
#include "suite/store/plain_text.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kNoValue =
    "must be text, a number, a boolean or a list of these";

std::string at_line(const std::string& path, std::size_t line) {
  return fmt::format("{}:{}", path, line);
}

/// Counts the lines that a parser has read.
class LineCounter {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  LineCounter(const char* at, std::size_t& line) : at_(at), line_(&line) {}
  reference operator*() const { return *at_; }
  LineCounter& operator++() {
    *line_ += *at_ == '\n' ? 1 : 0;
    ++at_;
    return *this;
  }
  bool operator==(const LineCounter& o) const { return at_ == o.at_; }
  bool operator!=(const LineCounter& o) const { return at_ != o.at_; }

 private:
  const char* at_;
  std::size_t* line_;
};

/// The document; `lines` gets those of its keys.
Json parsed_json(const std::string& path,
                 const std::string& text,
                 std::map<std::string, std::size_t>& lines) {
  std::size_t line = 1;
  const auto note = [&](int depth, Json::parse_event_t event, Json& key) {
    if (event != Json::parse_event_t::key || depth != 1) return true;
    const auto& name = key.get_ref<const std::string&>();
    if (!lines.emplace(name, line).second)
      throw UsageError(
          fmt::format("{}: '{}' appears twice", at_line(path, line), name));
    return true;
  };
  const char* begin = text.data();
  try {
    return Json::parse(
        LineCounter(begin, line), LineCounter(begin + text.size(), line), note);
  } catch (const Json::exception& error) {
    const std::string_view what = error.what();
    const auto from = what.find("column ");
    throw UsageError(
        fmt::format("{}: the file of --config is not valid JSON{}{}",
                    at_line(path, line),
                    from == what.npos ? "" : ": ",
                    from == what.npos ? "" : what.substr(from)));
  }
}

std::string text_of(const Json& value, const FileFlag& flag) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_structured() || value.is_null())
    throw UsageError(fmt::format("{}: {} {}", flag.where, flag.name, kNoValue));
  return value.dump();
}

std::vector<FileFlag> from_json(const std::string& path,
                                const std::string& text) {
  std::map<std::string, std::size_t> lines;
  const Json all = parsed_json(path, text, lines);
  if (!all.is_object())
    throw UsageError(fmt::format(
        "{} is not a JSON object of flags, such as {{\"profile\": \"smoke\"}}",
        path));
  std::vector<FileFlag> flags;
  for (const auto& [name, value] : all.items()) {
    FileFlag flag{
        .name = name, .values = {}, .where = at_line(path, lines.at(name))};
    if (value.is_array()) {
      for (const Json& one : value) flag.values.push_back(text_of(one, flag));
    } else {
      flag.values.push_back(text_of(value, flag));
    }
    flags.push_back(std::move(flag));
  }
  return flags;
}

std::string text_of(const toml::node& node, const FileFlag& flag) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_integer())
    return fmt::format("{}", number->get());
  if (const auto* number = node.as_floating_point())
    return fmt::format("{}", number->get());
  if (const auto* yes = node.as_boolean()) return yes->get() ? "true" : "false";
  throw UsageError(fmt::format("{}: {} {}", flag.where, flag.name, kNoValue));
}

toml::table parsed_toml(const std::string& path, std::string_view text) {
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw UsageError(
        fmt::format("{}:{}: the file of --config is not valid TOML: {}",
                    path,
                    error.source().begin.line,
                    error.description()));
  }
}

/// TOML 1.0 without tables, dates or lists in lists.
std::vector<FileFlag> from_toml(const std::string& path,
                                std::string_view text) {
  const toml::table all = parsed_toml(path, text);
  std::vector<std::pair<toml::source_position, FileFlag>> found;
  for (const auto& [key, node] : all) {
    const toml::source_position at = key.source().begin;
    FileFlag flag{.name = std::string(key.str()),
                  .values = {},
                  .where = fmt::format("{}:{}", path, at.line)};
    if (const toml::array* list = node.as_array()) {
      for (const toml::node& one : *list)
        flag.values.push_back(text_of(one, flag));
    } else {
      flag.values.push_back(text_of(node, flag));
    }
    found.emplace_back(at, std::move(flag));
  }
  // A table sorts its keys.
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first.line, a.first.column) <
           std::pair(b.first.line, b.first.column);
  });
  std::vector<FileFlag> flags;
  for (auto& [at, flag] : found) flags.push_back(std::move(flag));
  return flags;
}

void check_values(const FileFlag& flag) {
  if (flag.values.empty())
    throw UsageError(
        fmt::format("{}: {} is an empty list; leave it out or give it a value",
                    flag.where,
                    flag.name));
  for (const std::string& value : flag.values)
    if (value.empty() || value.find('\0') != value.npos)
      throw UsageError(fmt::format(
          "{}: --{}= {}; leave it out or give it a value",
          flag.where,
          flag.name,
          value.empty() ? "is empty" : "contains a null character"));
}

}  // namespace

std::vector<FileFlag> read_campaign_file(const std::string& path) {
  const std::string text = read_plain_text(path, kLongestFile);
  const auto begin = text.find_first_not_of(" \t\r\n");
  const bool is_json =
      path.ends_with(".json") ||
      (!path.ends_with(".toml") && begin != text.npos && text[begin] == '{');
  auto flags = is_json ? from_json(path, text) : from_toml(path, text);
  for (const FileFlag& flag : flags) check_values(flag);
  return flags;
}

}  // namespace physinv
