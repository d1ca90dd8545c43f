#include "suite/app/against_baseline.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <type_traits>

#include "suite/app/load.h"
#include "suite/gate/digits.h"
#include "suite/gate/instructions.h"
#include "suite/gate/verdict.h"
#include "suite/harness/build_info.h"
#include "suite/results/nearest.h"
#include "suite/store/file.h"

namespace physinv {
namespace {

template <class Line>
std::string case_name(const Line& line) {
  if constexpr (std::is_same_v<Line, StageLine>) return case_of(line.name);
  return line.name;
}

/// Lines whose case matches.
template <class Line>
std::vector<Line> matching(std::vector<Line> lines, const NameFilter& filter) {
  std::erase_if(lines, [&](const Line& line) {
    return !filter.matches(case_name(line));
  });
  return lines;
}

}  // namespace

AgainstBaseline::AgainstBaseline(const GateFlags& flags)
    : flags_(flags),
      filter_(flags.filters),
      before_(read_baseline(flags.baseline)) {
  if (!flags.profile.empty() && flags.profile != before_.chosen.profile)
    throw UsageError(fmt::format("{} is of profile {}, not {}",
                                 flags.baseline,
                                 before_.chosen.profile,
                                 flags.profile));
  cases_ = cases_of(before_.chosen, flags.filters, flags.baseline + ": filter");
  lines_ = matching(before_.stages, filter_);
  require_something();
}

void AgainstBaseline::judge_stages(GateReport& report) {
  now_ =
      flags_.results.empty()
          ? measure(cases_, flags_.measuring(), Screen::of(stdout))
          : matching(lines_of(load(flags_.results).results.cases()), filter_);
  const Rules rules{.bits = same_bits(), .allow_work = flags_.allow_work};
  if (!rules.bits)
    report.notes.push_back(fmt::format(
        "{} is of other libraries or flags ({}): judged within its stable "
        "digits, which {} of {} stages do not have: their losses decide "
        "nothing",
        flags_.baseline,
        before_.bits,
        std::count_if(lines_.begin(),
                      lines_.end(),
                      [](auto& line) { return line.digits == kNoDigits; }),
        lines_.size()));
  for (const auto& j : judge(lines_, now_, rules))
    report.findings.push_back(finding_of(j));
}

void AgainstBaseline::judge_instructions(GateReport& report) {
  const auto lines = countable();
  if (lines.empty() || !flags_.count) return;
  const std::string elsewhere =
      not_comparable(before_.counts.counter, build_info().instruction_set);
  if (!elsewhere.empty())
    return leave_counts(lines, "not compared", elsewhere, report);
  const auto counting = before_.counts.counter == counter_name(Counting::perf)
                            ? Counting::perf
                            : Counting::callgrind;
  std::string why = "the baseline is from another build";
  if (!same_build() || !can_count(counting, counting_program(), &why))
    return leave_counts(lines, "not counted", why, report);
  std::vector<std::string> names;
  for (const auto& line : lines) names.push_back(line.name);
  counts_ = count_instructions(
      counting, counting_program(), before_.chosen.profile, names);
  for (std::size_t i = 0; i < lines.size(); ++i)
    report.findings.push_back(judge(lines[i], counts_.lines[i]));
}

void AgainstBaseline::leave_counts(const std::vector<CountLine>& lines,
                                   const std::string& verdict,
                                   const std::string& why,
                                   GateReport& report) const {
  report.findings.push_back(
      {.kind = "instructions",
       .name = fmt::format("{} cases", lines.size()),
       .verdict = verdict,
       .detail = why,
       .code = flags_.strict ? ExitCode::inconclusive : ExitCode::good,
       .numbers = {{"recorded_by", before_.counts.counter}}});
}

void AgainstBaseline::renew() {
  measure_digits(now_, cases_, flags_.measuring(), Screen::of(stdout));
  Baseline renewed = blank_baseline(before_.chosen);
  std::map<std::string, StageLine> fresh;
  for (const auto& line : now_) fresh.emplace(line.name, line);
  for (const auto& line : before_.stages) {
    const auto at = fresh.find(line.name);
    if (at != fresh.end()) {
      renewed.stages.push_back(at->second);
      fresh.erase(at);
    } else if (!filter_.matches(case_of(line.name))) {
      renewed.stages.push_back(line);
    }
  }
  for (const auto& line : now_)
    if (fresh.contains(line.name)) renewed.stages.push_back(line);
  renewed.counts = renewed_counts();
  // Counts that stay are of the build that counted them.
  const bool kept = counts_.lines.empty() && !renewed.counts.lines.empty();
  if (kept) renewed.build = before_.build;
  write_atomically(flags_.baseline, to_text(renewed));
  fmt::print("renewed {}: {} stages{}\n",
             flags_.baseline,
             renewed.stages.size(),
             kept ? fmt::format("; instruction counts of {} are kept",
                                renewed.counts.counter)
                  : "");
}

/// Nothing passes because nothing was judged.
void AgainstBaseline::require_something() const {
  if (!lines_.empty()) return;
  std::vector<std::string> names;
  for (const auto& line : before_.stages) names.push_back(case_of(line.name));
  std::string asked;
  for (const auto& f : flags_.filters) asked += (asked.empty() ? "" : " ") + f;
  const auto near = nearest_names(names, asked);
  throw ExitError(ExitCode::nothing_matched,
                  fmt::format("no case of {} matches '{}'; nearest is {}",
                              flags_.baseline,
                              asked,
                              near.empty() ? names.front() : near.front()));
}

/// Of cases that are gone, their stages tell.
std::vector<CountLine> AgainstBaseline::countable() const {
  std::set<std::string> known;
  for (const Case& c : cases_) known.insert(c.info.name);
  auto lines = matching(before_.counts.lines, filter_);
  std::erase_if(lines,
                [&](const auto& line) { return !known.contains(line.name); });
  return lines;
}

CountTable AgainstBaseline::renewed_counts() const {
  CountTable table = before_.counts;
  for (CountLine& line : table.lines)
    for (const CountLine& now : counts_.lines)
      if (now.name == line.name) line = now;
  std::set<std::string> registered;
  for (const Case& c : cases_of(before_.chosen)) registered.insert(c.info.name);
  std::erase_if(table.lines, [&](const auto& line) {
    return !registered.contains(line.name);
  });
  return table;
}

}  // namespace physinv
