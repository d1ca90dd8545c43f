#include "suite/harness/select.h"

#include <fmt/format.h>
#include <re2/re2.h>

#include <algorithm>
#include <map>
#include <numeric>

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

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

// A distance takes time in proportion to both lengths.
constexpr std::size_t kMostCompared = 2000, kLongestCompared = 256;

std::vector<std::string> nearest_names(const std::vector<std::string>& names,
                                       std::string_view pattern,
                                       std::size_t count) {
  constexpr std::size_t kLongestWord = 64;  // its distance is quadratic
  pattern = pattern.substr(0, kLongestWord);
  pattern = pattern.substr(0, kLongestCompared);
  std::map<std::string, std::size_t> score;  // of a path's beginning
  for (const auto& name : names) {
    std::size_t begin = 0;
    while (begin <= name.size()) {
      const std::size_t end = std::min(name.find('/', begin), name.size());
      const auto part = std::string_view(name).substr(begin, end - begin);
      const auto head = std::string_view(name).substr(0, end);
      const auto [at, is_new] = score.try_emplace(std::string(head), 0);
      if (is_new)
        at->second = std::min(edit_distance(part, pattern),
                              edit_distance(head, pattern));
      begin = end + 1;
    }
    if (score.size() >= kMostCompared) break;
  }
  std::vector<std::pair<std::size_t, std::string>> order;
  for (const auto& [head, d] : score) order.emplace_back(d, head);
  std::sort(order.begin(), order.end());
  std::vector<std::string> best;
  for (std::size_t i = 0; i < std::min(count, order.size()); ++i)
    best.push_back(order[i].second);
  return best;
}

std::vector<std::string> nearest_words(std::vector<std::string> known,
                                       std::string_view word,
                                       std::size_t count) {
  word = word.substr(0, kLongestCompared);
  std::map<std::string, std::size_t> distance;
  for (const auto& k : known) distance[k] = edit_distance(k, word);
  std::stable_sort(known.begin(), known.end(), [&](auto& a, auto& b) {
    return distance[a] < distance[b];
  });
  known.resize(std::min(count, known.size()));
  return known;
}

std::string nearest_word(const std::vector<std::string>& known,
                         std::string_view word) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const auto& k : known) {
    const std::size_t d = edit_distance(k, word);
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
