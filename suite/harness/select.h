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
  /// Throws UsageError naming the pattern that is not a regular expression, or
  /// too long, and `whose` it is.
  explicit NameFilter(const std::vector<std::string>& patterns,
                      std::string_view whose = "--filter");

  bool matches(const std::string& name) const;
  std::vector<Case> apply(const std::vector<Case>& cases) const;

 private:
  using Patterns = std::vector<std::shared_ptr<const re2::RE2>>;
  Patterns wanted_, unwanted_;
};

/// The pattern that matches this name and no other.
std::string exactly(std::string_view name);

/// Part `part` of `parts` (from 1): the cases at positions part-1,
/// part-1+parts, .. of the list.
struct Shard {
  int part = 1, parts = 1;
  std::vector<Case> apply(std::vector<Case> cases) const;
};

}  // namespace physinv
