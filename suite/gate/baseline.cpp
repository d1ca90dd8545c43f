#include "suite/gate/baseline.h"

#include <fmt/format.h>
#include <gnu/libc-version.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <stdexcept>

#include "suite/core/decimal.h"
#include "suite/harness/build_info.h"
#include "suite/harness/context.h"
#include "suite/harness/revision.h"
#include "suite/store/checksum.h"
#include "suite/store/file.h"
#include "suite/store/plain_text.h"

namespace physinv {
namespace {

constexpr std::string_view kTitle = "physinv-bench baseline ";
constexpr std::string_view kSeal = "checksum ";
constexpr int kVersion = 1;
constexpr std::string_view kMake = "'baseline' writes one";

/// A line and its parts, taken from the front.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  bool empty() const { return rest_.empty(); }
  std::string_view next() {
    const auto end = rest_.find('\n');
    if (end == std::string_view::npos)
      throw std::runtime_error("it ends unexpectedly");
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return line;
  }

 private:
  std::string_view rest_;
};

std::pair<std::string, std::string> first_word_and_rest(std::string_view line) {
  const auto at = line.find(' ');
  if (at == std::string_view::npos) return {std::string(line), ""};
  return {std::string(line.substr(0, at)), std::string(line.substr(at + 1))};
}

std::uint64_t parse_count(std::string_view text) {
  if (const auto value = decimal<std::uint64_t>(text)) return *value;
  throw std::runtime_error(fmt::format("'{}' is not a count", text));
}

void read_stages(Baseline& b, Lines& lines, const std::string& how_many) {
  std::set<std::string> names;
  for (auto left = parse_count(how_many); left > 0; --left) {
    b.stages.push_back(stage_line(lines.next()));
    if (!names.insert(b.stages.back().name).second)
      throw std::runtime_error(b.stages.back().name + " appears twice");
  }
}

void read_counts(Baseline& b, Lines& lines, const std::string& head) {
  const auto [how_many, counter] = first_word_and_rest(head);
  b.counts.counter = counter;
  for (auto left = parse_count(how_many); left > 0; --left) {
    const auto [name, value] = first_word_and_rest(lines.next());
    b.counts.lines.push_back({name, parse_count(value)});
  }
}

/// Lines of the header, which every baseline has once.
struct HeaderLine {
  std::string_view key;
  std::string Baseline::*text;
};
constexpr HeaderLine kHeader[] = {{"bits", &Baseline::bits},
                                  {"build", &Baseline::build},
                                  {"numerics", &Baseline::numerics},
                                  {"machine", &Baseline::machine},
                                  {"revision", &Baseline::revision},
                                  {"date", &Baseline::date}};

Baseline parse_body(Lines lines) {
  Baseline b;
  std::set<std::string, std::less<>> seen;
  while (!lines.empty()) {
    const auto [key, value] = first_word_and_rest(lines.next());
    const bool repeats = key == "filter" || key == "set";
    const bool may_be_empty = key == "revision";  // outside of git
    if (!value.empty() || may_be_empty)
      if (!seen.insert(key).second && !repeats)
        throw std::runtime_error(fmt::format("'{}' appears twice", key));
    if (key == "profile") b.chosen.profile = value;
    if (key == "seeds") b.chosen.seeds = value;
    if (key == "filter") b.chosen.filters.push_back(value);
    if (key == "set") b.chosen.sets.push_back(value);
    for (const HeaderLine& line : kHeader)
      if (key == line.key) b.*line.text = value;
    if (key == "stages") read_stages(b, lines, value);
    if (key == "instructions") read_counts(b, lines, value);
  }
  const auto require = [&](std::string_view key) {
    if (!seen.contains(key))
      throw std::runtime_error(fmt::format("it has no {}", key));
  };
  require("profile");
  for (const HeaderLine& line : kHeader) require(line.key);
  require("stages");
  return b;
}

/// The text without its last line, which must be its checksum.
std::string_view unsealed(std::string_view text, const std::string& where) {
  const auto at = text.rfind(kSeal);
  const std::string_view body =
      text.substr(0, at == std::string_view::npos ? 0 : at);
  if (!body.empty() &&
      text.substr(at) == fmt::format("{}{:08x}\n", kSeal, crc32c(body)))
    return body;
  if (text.starts_with(kTitle) &&
      text.substr(0, text.find('\n')).ends_with('\r'))
    throw StoreError(
        fmt::format("{} has lines that end with CR and LF, as git writes them "
                    "with core.autocrlf; a baseline needs LF (add '{} -text' "
                    "to .gitattributes and check it out again)",
                    where,
                    where));
  if (text.starts_with(kTitle))
    throw StoreError(
        fmt::format("{} is damaged: its checksum is wrong (restore it from "
                    "version control; {})",
                    where,
                    kMake));
  throw UnreadableInput(fmt::format("{} is not a baseline; {}", where, kMake));
}

}  // namespace

std::string bits_text() {
  const BuildInfo& b = build_info();
  return fmt::format("Eigen-{} SLEEF-{} glibc-{} {}",
                     b.eigen,
                     b.sleef,
                     gnu_get_libc_version(),
                     b.bit_flags);
}

std::string build_text() {
  const BuildInfo& b = build_info();
  const std::string flags = std::regex_replace(
      std::string(b.flags), std::regex(" ?-m(arch|tune)=\\S*"), "");
  return fmt::format("{} {} {}", b.compiler, b.compiler_version, flags);
}

Baseline blank_baseline(Chosen chosen) {
  const auto context = machine_context(git_revision());
  return {.chosen = std::move(chosen),
          .bits = bits_text(),
          .build = build_text(),
          .numerics = std::string(build_info().fingerprint),
          .machine = fmt::format("{}, {} cores, {}",
                                 context.value("cpu_model", ""),
                                 context.value("num_cpus", 0),
                                 build_info().instruction_set),
          .revision = context.value("git_revision", "") +
                      (context.value("git_dirty", false) ? "+dirty" : ""),
          .date = context.value("date", ""),
          .stages = {},
          .counts = {}};
}

std::string to_text(const Baseline& b) {
  std::string text =
      fmt::format("{}{}\nprofile {}\n", kTitle, kVersion, b.chosen.profile);
  for (const auto& filter : b.chosen.filters) text += "filter " + filter + '\n';
  for (const auto& set : b.chosen.sets) text += "set " + set + '\n';
  if (!b.chosen.seeds.empty()) text += "seeds " + b.chosen.seeds + '\n';
  for (const HeaderLine& line : kHeader)
    text += fmt::format("{} {}\n", line.key, b.*line.text);
  text += fmt::format("stages {}\n", b.stages.size());
  for (const auto& line : b.stages) text += to_text(line) + '\n';
  if (!b.counts.counter.empty())
    text += fmt::format(
        "instructions {} {}\n", b.counts.lines.size(), b.counts.counter);
  for (const auto& line : b.counts.lines)
    text += fmt::format("{} {}\n", line.name, line.instructions);
  return text + fmt::format("{}{:08x}\n", kSeal, crc32c(text));
}

Baseline parse_baseline(const std::string& text, const std::string& where) {
  Lines lines(unsealed(text, where));
  try {
    const std::string_view title = lines.next();
    if (!title.starts_with(kTitle))
      throw std::runtime_error("its first line is wrong");
    if (parse_count(title.substr(kTitle.size())) > kVersion)
      throw std::runtime_error("its version is newer than this program");
    Baseline b = parse_body(lines);
    if (b.stages.empty()) throw std::runtime_error("it has no stages");
    return b;
  } catch (const std::runtime_error& error) {
    throw UnreadableInput(
        fmt::format("{} is not a baseline for this program: {}; {}",
                    where,
                    error.what(),
                    kMake));
  }
}

Baseline read_baseline(const std::filesystem::path& path) {
  if (!is_file(path))
    throw UnreadableInput(
        fmt::format("there is no baseline '{}'; {}", path.string(), kMake));
  return parse_baseline(read_plain_text(path), path.string());
}

}  // namespace physinv
