#include "suite/app/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "suite/core/decimal.h"
#include "suite/harness/keys.h"
#include "suite/harness/registry.h"
#include "suite/harness/registry_errors.h"
#include "suite/harness/select.h"
#include "suite/harness/words.h"
#include "suite/results/nearest.h"
#include "suite/store/file.h"
#include "suite/store/plain_text.h"
#include "suite/store/plan.h"

namespace physinv {
namespace {

constexpr std::string_view kKeys = "n, seeds, iterations, precision, methods";
constexpr std::size_t kNearest = 5;

std::vector<std::string> split(std::string_view text, char at) {
  std::vector<std::string> parts;
  while (true) {
    const auto end = text.find(at);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

/// What a key may be. More than any experiment needs, and little enough that
/// counts, sums and memory stay within bounds.
struct Range {
  Index least, most;
};
constexpr Range kSizes{1, 1'000'000}, kIterations{1, 1'000'000'000};
constexpr Range kSeeds{0, (Index{1} << 53) - 1};  // exact in any JSON reader
constexpr Range kShards{1, 1'000'000};
constexpr std::size_t kLongestList = 100'000;

Index number(std::string_view key, std::string_view text, Range range) {
  const auto value = decimal<Index>(text);
  if (!value || *value < range.least || *value > range.most)
    throw UsageError(fmt::format(
        "'{}' is not a value for {}; expected a whole number from {} to {}",
        text,
        key,
        range.least,
        range.most));
  return *value;
}

/// "0,1" or "0-3", also mixed.
template <class T>
std::vector<T> numbers(std::string_view key,
                       std::string_view text,
                       Range range) {
  std::vector<T> all;
  for (const auto& part : split(text, ',')) {
    const auto dash = part.find('-', 1);
    const std::string_view from(part.data(), std::min(dash, part.size()));
    const Index first = number(key, from, range);
    const Index last = dash == std::string::npos
                           ? first
                           : number(key, part.substr(dash + 1), range);
    if (last < first)
      throw UsageError(fmt::format(
          "{}={} is not a range; expected first-last with first <= last",
          key,
          part));
    if (all.size() + static_cast<std::size_t>(last - first) >= kLongestList)
      throw UsageError(fmt::format(
          "{} has more than {} values; give fewer", key, kLongestList));
    for (Index v = first; v <= last; ++v) all.push_back(static_cast<T>(v));
  }
  return all;
}

void set(Overrides& o, const std::string& key, const std::string& value) {
  if (key == "n") {
    o.n = numbers<Index>(key, value, kSizes);
  } else if (key == "seeds") {
    o.seeds = numbers<std::uint64_t>(key, value, kSeeds);
  } else if (key == "iterations") {
    o.iterations = number(key, value, kIterations);
  } else if (key == "methods") {
    o.methods = split(value, ',');
  } else if (key == "precision") {
    if (value != "f32" && value != "f64")
      throw UsageError("unknown precision '" + value +
                       "'; known values: f32, f64");
    o.precision = value == "f32" ? Precision::f32 : Precision::f64;
  } else {
    throw UsageError(
        fmt::format("--set has no key '{}'; known keys: {}", key, kKeys));
  }
}

/// Takes one method out of the first experiment of the profile.
std::string filter_example(const std::string& profile) {
  for (const auto& e : registry().experiments())
    for (const Profile& p : e->profiles)
      if (p.name == profile && !p.rows.empty())
        return fmt::format(
            "--filter=-{}/{}/", e->name, p.rows.front().methods.front());
  return "--filter=-NAME";
}

/// In the order of the file. All of them must be there: it is part of a whole.
std::vector<Case> listed(std::vector<Case> cases, const std::string& file) {
  if (!is_file(file))
    throw UsageError(
        fmt::format("there is no file '{}'; --cases needs a file with one case "
                    "name per line",
                    file));
  std::map<std::string, Case*> by_name;
  for (Case& c : cases) by_name[c.info.name] = &c;
  std::istringstream lines(read_plain_text(file));
  std::vector<Case> own;
  std::set<std::string> taken;
  std::string name;
  while (std::getline(lines, name)) {
    if (name.ends_with('\r')) name.pop_back();
    if (name.empty() || !taken.insert(name).second) continue;
    const auto at = by_name.find(name);
    if (at == by_name.end())
      throw UsageError(
          fmt::format("{} names {}, which is not selected; 'list' prints the "
                      "selected cases",
                      file,
                      name));
    own.push_back(*at->second);
  }
  return own;
}

}  // namespace

std::vector<Flag> Selection::flags(const std::vector<Flag>& own) {
  std::vector<Flag> chosen = {
      {"--filter",
       fmt::format("select cases by name: a word, such as billiards, selects "
                   "the papers' experiments whose name has it as a part; "
                   "anything else is a regular expression; a leading - "
                   "excludes ({}); several filters are combined",
                   filter_example(profile)),
       &filters,
       "REGEX"},
      {"--all",
       "search words in all experiments, including those of no paper (matrix, "
       "numerics)",
       &all},
      {"--profile",
       fmt::format(
           "{}; default: {}", fmt::join(registry().profiles(), ", "), profile),
       &profile,
       "NAME"},
      {"--set",
       fmt::format("override a key of the profile's rows, e.g. "
                   "n=8,32; keys: {}",
                   kKeys),
       &sets,
       "KEY=VALUE"},
      {"--seeds", "the same as --set seeds=LIST; 0,2 or 0-3", &seeds, "LIST"},
      {"--shard",
       "part I (from 1) of N: every N-th case of the selection",
       &shard,
       "I/N"},
      {"--cases",
       "run only selected cases whose names are in this file, one per line",
       &list,
       "FILE"}};
  chosen.insert(chosen.end(), own.begin(), own.end());
  return chosen;
}

Flag Selection::arguments() {
  return {.name = "FILTER",
          .help = "the same as --filter=FILTER; must match a case",
          .to = &words,
          .optional = true};
}

std::vector<Case> Selection::cases(std::vector<PlannedCase>* campaign) {
  for (const auto* texts : {&filters, &words}) NameFilter{*texts};
  const Shard part = parse_shard(shard);
  const auto everything =
      registry().expand(profile, parse_overrides(sets, seeds));
  read_words(everything);
  auto chosen = NameFilter(filters).apply(everything);
  // What is wrong may be why nothing is chosen.
  chosen.empty() ? registry().validate() : validate(registry(), chosen);
  if (campaign != nullptr) *campaign = planned(chosen);
  if (chosen.empty())
    refuse(everything, fmt::format("{}", fmt::join(filters, " ")));
  return list.empty() ? part.apply(std::move(chosen))
                      : listed(std::move(chosen), list);
}

void Selection::read_words(const std::vector<Case>& all_cases) {
  if (!plain) filters = expressions_of(filters, all_cases, all);
  for (const auto& word : std::exchange(words, {})) {
    filters.push_back(expressions_of({word}, all_cases, all).front());
    const NameFilter filter({filters.back()});
    if (std::none_of(all_cases.begin(), all_cases.end(), [&](const Case& c) {
          return filter.matches(c.info.name);
        }))
      refuse(all_cases, word);
  }
}

void Selection::refuse(const std::vector<Case>& all_cases,
                       const std::string& asked) const {
  std::vector<std::string> names;
  for (const Case& c : all_cases) names.push_back(c.info.name);
  const auto near = nearest_names(names, asked, kNearest);
  throw ExitError(
      ExitCode::nothing_matched,
      near.empty()
          ? fmt::format("profile {} has no cases; see 'physinv-bench list'",
                        profile)
          : fmt::format("no case of profile {} matches '{}'; nearest: {}",
                        profile,
                        asked,
                        fmt::join(near, ", ")));
}

Overrides parse_overrides(const std::vector<std::string>& sets,
                          const std::string& seeds) {
  Overrides o;
  for (const auto& text : sets) {
    const auto at = text.find('=');
    if (at == std::string::npos || at + 1 == text.size())
      throw UsageError(fmt::format(
          "--set {} has no value; expected key=value with one of the keys {}",
          text,
          kKeys));
    set(o, text.substr(0, at), text.substr(at + 1));
  }
  if (!seeds.empty()) set(o, "seeds", seeds);
  return o;
}

double parse_duration(const std::string& flag, const std::string& text) {
  double value{};
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  const std::string_view unit(at, static_cast<std::size_t>(end - at));
  const double seconds = unit.empty() || unit == "s"    ? 1
                         : unit == "m" || unit == "min" ? 60
                         : unit == "h"                  ? 3600
                                                        : 0;
  if (error != std::errc() || !(value * seconds > 0) || value > 1e9)
    throw UsageError(
        fmt::format("{}={} is not positive and finite; expected a time such as "
                    "90, 90s, 10m or 2h",
                    flag,
                    text));
  return value * seconds;
}

Shard parse_shard(const std::string& text) {
  if (text.empty()) return {};
  const auto parts = split(text, '/');
  if (parts.size() != 2)
    throw UsageError("--shard=" + text +
                     " is not I/N; expected a part such as 1/3");
  const Shard s{static_cast<int>(number("--shard", parts[0], kShards)),
                static_cast<int>(number("--shard", parts[1], kShards))};
  if (s.part > s.parts)
    throw UsageError(
        fmt::format("--shard={} is not a part; expected 1/{} to {}/{}",
                    text,
                    s.parts,
                    s.parts,
                    s.parts));
  return s;
}

std::filesystem::path results_directory(const std::string& text) {
  if (!is_folder(text))
    throw UsageError(
        fmt::format("there are no results in '{}'; expected a directory that "
                    "'run' wrote, such as results/quick",
                    text));
  return text;
}

}  // namespace physinv
