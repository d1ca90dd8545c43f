/// Choosing cases: by name, and by shard.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "suite/harness/case.h"

namespace re2 {
class RE2;
}

namespace physinv {

inline constexpr std::size_t kLongestPattern = 4096;
inline constexpr std::size_t kLongestPatterns = 1 << 18;  ///< in sum

/// Regular expressions (RE2, searched anywhere in the name), whose time is
/// linear in pattern and name. A leading '-' negates. A name passes if it
/// matches any positive pattern (or there is none) and no negative one.
class NameFilter {
 public:
  NameFilter() = default;
  /// Throws UsageError naming the pattern that is no regular expression, or
  /// too long, and `whose` it is.
  explicit NameFilter(const std::vector<std::string>& patterns,
                      std::string_view whose = "--filter");

  bool matches(const std::string& name) const;
  std::vector<Case> apply(std::vector<Case> cases) const;

 private:
  using Patterns = std::vector<std::shared_ptr<const re2::RE2>>;
  Patterns wanted_, unwanted_;
};

/// The pattern that matches this name and no other.
std::string exactly(std::string_view name);

/// Up to `count` beginnings of names whose last part reads most like
/// `pattern`, best first.
std::vector<std::string> nearest_names(const std::vector<std::string>& names,
                                       std::string_view pattern,
                                       std::size_t count = 3);

/// Levenshtein distance, or more than `most` if it is.
std::size_t edit_distance(std::string_view a,
                          std::string_view b,
                          std::size_t most = 1'000'000);

/// Up to `count` of `known`, the one that reads most like `word` first.
std::vector<std::string> nearest_words(const std::vector<std::string>& known,
                                       std::string_view word,
                                       std::size_t count = 5);

/// The word of `known` nearest to `word`, empty if none is near.
std::string nearest_word(const std::vector<std::string>& known,
                         std::string_view word);

/// Part `part` of `parts` (from 1): the cases at positions part-1,
/// part-1+parts, .. of the list.
struct Shard {
  int part = 1, parts = 1;
  std::vector<Case> apply(std::vector<Case> cases) const;
};

}  // namespace physinv
