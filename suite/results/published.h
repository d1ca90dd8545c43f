/// The papers and their printed numbers, from reports/published/<paper>.json.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace physinv {

/// What the numbers were printed in.
struct Publication {
  std::string key;  ///< "jpo", what a case's `Citation` calls it
  std::string title;
  std::vector<std::string> authors;
  int year = 0;
  std::string venue;
  std::string arxiv;     ///< "2203.10131"; may be empty
  std::string question;  ///< that the paper asks; may be empty
  /// Experiment and id of the claims that answer it, the main one first.
  std::vector<std::pair<std::string, std::string>> main_claims;

  /// "Ann Ames, Bo Berg: Title. Venue, 2022. arXiv:2203.10131"
  std::string text() const;
};

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
  /// Reads every *.json of the directory; StoreError with file and reason if
  /// one is malformed.
  explicit Published(const std::filesystem::path& directory);
  /// The bytes of one more file; `path` is for messages.
  void add(std::string_view bytes, const std::filesystem::path& path);

  std::optional<PublishedValue> find(std::string_view experiment,
                                     std::string_view quantity) const;

  /// In the order of their keys.
  const std::vector<Publication>& publications() const { return publications_; }
  /// Null if there is none of this key.
  const Publication* publication(std::string_view key) const;

 private:
  std::vector<Publication> publications_;
  std::map<std::string, PublishedValue> values_;
};

}  // namespace physinv
