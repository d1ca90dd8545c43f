/// The papers' printed numbers, from reports/published/<paper>.json.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace physinv {

struct PublishedValue {
  double value = 0;
  std::optional<double> spread;
  std::string where;  ///< "Table 4"
};

/// Looked up as (experiment, quantity), for example
/// ("jpo/billiards", "table4/jpo/better").
class Published {
 public:
  Published() = default;
  /// Reads every *.json of the directory; throws std::runtime_error with file
  /// and reason if one is malformed.
  explicit Published(const std::filesystem::path& directory);

  std::optional<PublishedValue> find(std::string_view experiment,
                                     std::string_view quantity) const;

 private:
  std::map<std::string, PublishedValue> values_;
};

}  // namespace physinv
