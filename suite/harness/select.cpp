#include "suite/harness/select.h"

#include <fmt/format.h>
#include <re2/re2.h>

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <numeric>
#include <set>

#include "suite/harness/errors.h"

namespace physinv {

namespace {

/// What a pattern may take of memory, in bytes.
constexpr std::int64_t kPatternMemory = 1 << 20;

std::shared_ptr<const RE2> compiled(const std::string& pattern,
                                    const std::string& text,
                                    std::string_view whose) {
  if (text.size() > kLongestPattern)
    throw UsageError(
        fmt::format("{} is a regular expression of {} characters; up to {} are "
                    "searched in case names",
                    whose,
                    text.size(),
                    kLongestPattern));
  RE2::Options options;
  options.set_log_errors(false);
  options.set_max_mem(kPatternMemory);
  auto compiled = std::make_shared<const RE2>(text, options);
  if (!compiled->ok())
    throw UsageError(fmt::format(
        "{}='{}' is no regular expression ({}); it is searched in case names, "
        "e.g. --filter='billiards/(jpo|bfgs)/'",
        whose,
        pattern,
        compiled->error()));
  return compiled;
}

}  // namespace

NameFilter::NameFilter(const std::vector<std::string>& patterns,
                       std::string_view whose) {
  std::size_t all = 0;
  for (const auto& pattern : patterns) {
    all += pattern.size();
    if (all > kLongestPatterns)
      throw UsageError(
          fmt::format("{} has regular expressions of more than {} characters "
                      "together; --cases takes names from a file",
                      whose,
                      kLongestPatterns));
    const bool negative = pattern.starts_with('-');
    (negative ? unwanted_ : wanted_)
        .push_back(
            compiled(pattern, negative ? pattern.substr(1) : pattern, whose));
  }
}

bool NameFilter::matches(const std::string& name) const {
  const auto hit = [&](const auto& r) { return RE2::PartialMatch(name, *r); };
  return (wanted_.empty() ||
          std::any_of(wanted_.begin(), wanted_.end(), hit)) &&
         std::none_of(unwanted_.begin(), unwanted_.end(), hit);
}

std::string exactly(std::string_view name) {
  std::string pattern = "^";
  for (const char c : name) {
    if (std::string_view(".+*?()[]{}|^$\\").find(c) != std::string_view::npos)
      pattern += '\\';
    pattern += c;
  }
  return pattern + "$";
}

std::vector<Case> NameFilter::apply(std::vector<Case> cases) const {
  std::erase_if(cases, [&](const Case& c) { return !matches(c.info.name); });
  return cases;
}

std::size_t edit_distance(std::string_view a,
                          std::string_view b,
                          std::size_t most) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) > most)
    return most + 1;
  std::vector<std::size_t> rows(b.size() + 1);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::size_t* const row = rows.data();
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0], left = i, least = i;
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      left = std::min({diagonal + 1, left + 1, replaced});
      row[j] = left;
      least = std::min(least, left);
    }
    if (least > most) return most + 1;
  }
  return row[b.size()];
}

namespace {

// A distance takes time in proportion to both lengths.
constexpr std::size_t kMostCompared = 1000, kLongestCompared = 64;

/// The `count` nearest of what is offered, the nearest first; of those at the
/// same distance in the order of their names, each once.
class Nearest {
 public:
  Nearest(std::string_view word, std::size_t count)
      : word_(word.substr(0, kLongestCompared)), count_(count) {}

  /// `name` is as near as the nearest of `texts`.
  void offer(std::string_view name,
             std::initializer_list<std::string_view> texts) {
    std::size_t least = most();
    for (const auto text : texts)
      least = std::min(least, edit_distance(text, word_, least));
    best_.emplace(least, name);
    if (best_.size() > count_) best_.erase(std::prev(best_.end()));
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& [distance, name] : best_) all.emplace_back(name);
    return all;
  }

 private:
  /// One beyond what still has a place.
  std::size_t most() const {
    return best_.size() < count_ ? 2 * kLongestCompared * kMostCompared
                                 : best_.rbegin()->first + 1;
  }

  std::string_view word_;
  std::size_t count_;
  std::set<std::pair<std::size_t, std::string>> best_;
};

}  // namespace

std::vector<std::string> nearest_names(const std::vector<std::string>& names,
                                       std::string_view pattern,
                                       std::size_t count) {
  Nearest nearest(pattern, count);
  // Beginnings of paths, the shortest of all names first.
  std::set<std::string_view> seen;
  std::vector<std::size_t> begins(names.size(), 0);
  for (bool longer = true; longer;) {
    longer = false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string_view name = names[i];
      if (begins[i] > name.size()) continue;
      if (seen.size() >= kMostCompared) return nearest.names();
      const std::size_t begin = begins[i];
      const std::size_t end = std::min(name.find('/', begin), name.size());
      const auto head = name.substr(0, end);
      if (seen.insert(head).second)
        nearest.offer(head, {head.substr(begin), head});
      begins[i] = end + 1;
      longer = true;
    }
  }
  return nearest.names();
}

std::vector<std::string> nearest_words(const std::vector<std::string>& known,
                                       std::string_view word,
                                       std::size_t count) {
  Nearest nearest(word, count);
  for (const auto& k : known) nearest.offer(k, {k});
  return nearest.names();
}

std::string nearest_word(const std::vector<std::string>& known,
                         std::string_view word) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const auto& k : known) {
    const std::size_t d = edit_distance(k, word, least);
    if (d < least) least = d, best = k;
  }
  return best;
}

std::vector<Case> Shard::apply(std::vector<Case> cases) const {
  std::vector<Case> own;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (i % static_cast<std::size_t>(parts) ==
        static_cast<std::size_t>(part - 1))
      own.push_back(std::move(cases[i]));
  }
  return own;
}

}  // namespace physinv
