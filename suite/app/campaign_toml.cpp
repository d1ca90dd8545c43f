#include "suite/app/campaign_toml.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <utility>

#include "suite/harness/errors.h"

namespace physinv {
namespace {

std::string text_of(const toml::node& node, const FileFlag& flag) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_integer())
    return fmt::format("{}", number->get());
  if (const auto* number = node.as_floating_point())
    return fmt::format("{}", number->get());
  if (const auto* yes = node.as_boolean()) return yes->get() ? "true" : "false";
  throw UsageError(fmt::format("{}: {} {}", flag.where, flag.name, kNoValue));
}

toml::table parsed(const std::string& path, std::string_view text) {
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw UsageError(fmt::format("{}:{}: the file of --config is no TOML: {}",
                                 path,
                                 error.source().begin.line,
                                 error.description()));
  }
}

}  // namespace

std::vector<FileFlag> flags_of_toml(const std::string& path,
                                    std::string_view text) {
  const toml::table all = parsed(path, text);
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

}  // namespace physinv
