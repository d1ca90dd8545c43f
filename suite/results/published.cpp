#include "suite/results/published.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "suite/results/file.h"

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
          .year = j.at("year"),
          .venue = j.at("venue"),
          .arxiv = j.value("arxiv", "")};
}

std::vector<fs::path> json_files(const fs::path& directory) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& f : fs::directory_iterator(directory, error))
    if (f.path().extension() == ".json") files.push_back(f.path());
  if (error)
    throw std::runtime_error(
        fmt::format("{}: {}", directory.string(), error.message()));
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
  for (const auto& path : json_files(directory)) {
    try {
      const auto file = nlohmann::json::parse(read_file(path));
      publications_.push_back(publication_from(file.at("publication")));
      for (const auto& v : file.at("values")) {
        PublishedValue value;
        value.value = v.at("value");
        value.where = v.at("where");
        const auto& spread = v.at("spread");
        if (!spread.is_null()) value.spread = spread.get<double>();
        values_[key(v.at("experiment").get<std::string>(),
                    v.at("quantity").get<std::string>())] = std::move(value);
      }
    } catch (const std::exception& e) {
      throw std::runtime_error(fmt::format("{}: {}", path.string(), e.what()));
    }
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
