#include "suite/results/published.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "suite/store/file.h"
#include "suite/store/json.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

std::string key(std::string_view experiment, std::string_view quantity) {
  return fmt::format("{}\n{}", experiment, quantity);
}

Publication publication_from(const nlohmann::json& j) {
  return {.key = j.at("key"),
          .title = j.at("title"),
          .authors = j.at("authors"),
          .year = static_cast<int>(whole(j.at("year"))),
          .venue = j.at("venue"),
          .arxiv = j.value("arxiv", ""),
          .question = j.value("question", ""),
          .main_claims =
              j.value("main_claims", decltype(Publication::main_claims)())};
}

double real(const nlohmann::json& j) {
  if (!j.is_number()) throw std::runtime_error("a value is not a number");
  return j;
}

PublishedValue value_from(const nlohmann::json& j) {
  PublishedValue value{
      .value = real(j.at("value")), .spread = {}, .where = j.at("where")};
  const auto& spread = j.at("spread");
  if (!spread.is_null()) value.spread = real(spread);
  return value;
}

std::vector<fs::path> json_files(const fs::path& directory) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& f : fs::directory_iterator(directory, error))
    if (f.path().extension() == ".json") files.push_back(f.path());
  if (error)
    throw StoreError(
        fmt::format("cannot read {}: {}", directory.string(), error.message()));
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::string Publication::text() const {
  return fmt::format("{}: {}. {}, {}.{}",
                     fmt::join(authors, ", "),
                     title,
                     venue,
                     year,
                     arxiv.empty() ? "" : " arXiv:" + arxiv);
}

Published::Published(const fs::path& directory) {
  for (const auto& path : json_files(directory)) add(read_file(path), path);
}

void Published::add(std::string_view bytes, const fs::path& path) {
  try {
    const auto file = parse_json(bytes);
    publications_.push_back(publication_from(file.at("publication")));
    for (const auto& v : file.at("values"))
      values_[key(v.at("experiment").get<std::string>(),
                  v.at("quantity").get<std::string>())] = value_from(v);
  } catch (const std::exception& e) {
    throw StoreError(
        fmt::format("{} is damaged: {} (restore it)", path.string(), e.what()));
  }
}

std::optional<PublishedValue> Published::find(std::string_view experiment,
                                              std::string_view quantity) const {
  const auto at = values_.find(key(experiment, quantity));
  if (at == values_.end()) return std::nullopt;
  return at->second;
}

const Publication* Published::publication(std::string_view key) const {
  for (const Publication& p : publications_)
    if (p.key == key) return &p;
  return nullptr;
}

}  // namespace physinv
