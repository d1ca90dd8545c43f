#include "suite/harness/select.h"

#include <fmt/format.h>
#include <re2/re2.h>

#include <algorithm>

#include "suite/harness/errors.h"

namespace physinv {

namespace {

/// What a pattern may take of memory, in bytes.
constexpr std::int64_t kPatternMemory = 1 << 20;

std::shared_ptr<const RE2> compiled(const std::string& pattern,
                                    const std::string& text,
                                    std::string_view whose) {
  if (text.size() > kLongestPattern)
    throw UsageError(fmt::format(
        "{} is a regular expression of {} characters; the limit is {}",
        whose,
        text.size(),
        kLongestPattern));
  RE2::Options options;
  options.set_log_errors(false);
  options.set_max_mem(kPatternMemory);
  auto compiled = std::make_shared<const RE2>(text, options);
  if (!compiled->ok())
    throw UsageError(fmt::format(
        "{}='{}' is not a regular expression ({}); expected one that is "
        "searched in case names, e.g. --filter='billiards/(jpo|bfgs)/'",
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
                      "in total; --cases reads names from a file",
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

std::vector<Case> NameFilter::apply(const std::vector<Case>& cases) const {
  std::vector<Case> chosen;
  for (const Case& c : cases)
    if (matches(c.info.name)) chosen.push_back(c);
  return chosen;
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
