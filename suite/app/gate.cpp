#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>

#include "suite/app/gate_flags.h"
#include "suite/app/load.h"
#include "suite/app/options.h"
#include "suite/gate/digits.h"
#include "suite/gate/gate_report.h"
#include "suite/gate/instructions.h"
#include "suite/gate/paired_timing.h"
#include "suite/gate/verdict.h"
#include "suite/harness/build_info.h"
#include "suite/harness/context.h"
#include "suite/harness/progress.h"
#include "suite/harness/select.h"
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

/// The part of `gate` that holds cases against a baseline.
class AgainstBaseline {
 public:
  /// Throws if there is no such baseline, or nothing of it to judge.
  explicit AgainstBaseline(const GateFlags& flags)
      : flags_(flags),
        filter_(flags.filters),
        before_(read_baseline(flags.baseline)) {
    if (!flags.profile.empty() && flags.profile != before_.chosen.profile)
      throw UsageError(fmt::format("{} has the profile {}, not {}",
                                   flags.baseline,
                                   before_.chosen.profile,
                                   flags.profile));
    cases_ =
        cases_of(before_.chosen, flags.filters, flags.baseline + ": filter");
    lines_ = matching(before_.stages, filter_);
    require_something();
  }

  /// Runs the cases, or reads a campaign that did.
  void judge_stages(GateReport& report) {
    now_ =
        flags_.results.empty()
            ? measure(cases_, flags_.measuring(), Screen::of(stdout))
            : matching(lines_of(load(flags_.results).results.cases()), filter_);
    const Rules rules{.bits = same_bits(), .allow_work = flags_.allow_work};
    if (!rules.bits)
      report.notes.push_back(fmt::format(
          "{} is from other libraries or flags ({}), so only its stable digits "
          "are compared; {} of {} stages have none, and their losses are not "
          "compared",
          flags_.baseline,
          before_.bits,
          std::count_if(lines_.begin(),
                        lines_.end(),
                        [](auto& line) { return line.digits == kNoDigits; }),
          lines_.size()));
    for (const auto& j : judge(lines_, now_, rules))
      report.findings.push_back(finding_of(j));
  }

  /// Where the baseline has them and this build can count.
  void judge_instructions(GateReport& report) {
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

  /// The new lines in the place of the old ones; lines of stages that are gone
  /// are removed. Counts that were not made again, as on another processor,
  /// stay with their build.
  void renew() {
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
               kept
                   ? fmt::format("; the instruction counts of {} are unchanged",
                                 renewed.counts.counter)
                   : "");
  }

  const Baseline& before() const { return before_; }
  const std::vector<Case>& cases() const { return cases_; }

 private:
  bool same_bits() const { return before_.bits == bits_text(); }
  bool same_build() const {
    return same_bits() && before_.build == build_text();
  }

  /// Nothing passes because nothing was judged.
  void require_something() const {
    if (!lines_.empty()) return;
    std::vector<std::string> names;
    for (const auto& line : before_.stages) names.push_back(case_of(line.name));
    const auto asked = fmt::format("{}", fmt::join(flags_.filters, " "));
    const auto near = nearest_names(names, asked);
    throw ExitError(ExitCode::nothing_matched,
                    fmt::format("no case of {} matches '{}'; did you mean {}?",
                                flags_.baseline,
                                asked,
                                near.empty() ? names.front() : near.front()));
  }

  /// Without the lines of cases that are gone, whose stages are reported.
  std::vector<CountLine> countable() const {
    const auto known = names_of(cases_);
    auto lines = matching(before_.counts.lines, filter_);
    std::erase_if(lines,
                  [&](const auto& line) { return !known.contains(line.name); });
    return lines;
  }

  /// What the report says about counts that are not compared.
  void leave_counts(const std::vector<CountLine>& lines,
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

  CountTable renewed_counts() const {
    CountTable table = before_.counts;
    for (CountLine& line : table.lines)
      for (const CountLine& now : counts_.lines)
        if (now.name == line.name) line = now;
    const auto registered = names_of(cases_of(before_.chosen));
    std::erase_if(table.lines, [&](const auto& line) {
      return !registered.contains(line.name);
    });
    return table;
  }

  const GateFlags& flags_;
  NameFilter filter_;
  Baseline before_;
  std::vector<Case> cases_;
  std::vector<StageLine> lines_, now_;  ///< of the baseline that match; of now
  CountTable counts_;
};

/// A program, or a build directory with one.
std::filesystem::path program_in(const std::string& flag,
                                 const std::string& text) {
  std::filesystem::path path(text);
  if (is_folder(path)) path /= "physinv-bench";
  if (access(path.c_str(), X_OK) != 0)
    throw UsageError(
        fmt::format("{}={} is not a program; expected a physinv-bench or a "
                    "directory that contains one",
                    flag,
                    text));
  return std::filesystem::absolute(path);
}

std::filesystem::path head_of(const GateFlags& flags) {
  return flags.head.empty() ? std::filesystem::read_symlink("/proc/self/exe")
                            : program_in("--head", flags.head);
}

void judge_clock(const GateFlags& flags,
                 const Chosen& chosen,
                 const std::vector<Case>& cases,
                 GateReport& report) {
  PairedTimingOptions options{.base = program_in("--against", flags.against),
                              .head = head_of(flags),
                              .chosen = chosen,
                              .cases = {},
                              .out = flags.out,
                              .seconds = flags.budget,
                              .margin = flags.within / 100,
                              .seed = static_cast<std::uint64_t>(flags.seed)};
  setenv("PHYSINV_NO_REPORT", "1", 1);  // programs of other versions, too
  const auto before = cases_known_to(options.base, chosen);
  const auto after = cases_known_to(options.head, chosen);
  require_one_processor(options.base, options.head);
  for (const Case& c : cases)
    if (before.contains(c.info.name) && after.contains(c.info.name))
      options.cases.push_back(c.info.name);
  if (options.cases.empty())
    throw ExitError(ExitCode::nothing_matched,
                    fmt::format("{} has none of these {} cases",
                                options.base.string(),
                                cases.size()));
  if (options.cases.size() < cases.size())
    report.notes.push_back(fmt::format(
        "{} of {} cases were not timed, because one program lacks them",
        cases.size() - options.cases.size(),
        cases.size()));
  const PairedTiming timing = time_in_pairs(
      options, timed_run(options), [](std::size_t pair, std::size_t left) {
        fmt::print("pair {}: {} cases undecided\n", pair, left);
      });
  const std::size_t pairs =
      *std::max_element(timing.pairs.begin(), timing.pairs.end());
  report.notes.push_back(
      fmt::format("timed against {}: {} pairs in {}, order from seed {}",
                  options.base.string(),
                  pairs,
                  duration_text(timing.seconds),
                  options.seed));
  for (auto& finding : findings_of(options, timing, flags.strict))
    report.findings.push_back(std::move(finding));
}

void tell(const GateReport& report, const GateFlags& flags) {
  fmt::print("{}", terminal_text(report));
  if (!variable("GITHUB_ACTIONS").empty())
    fmt::print("{}", annotations(report));
  if (const auto path = variable("GITHUB_STEP_SUMMARY"); !path.empty())
    append_to(path, markdown_text(report));
  if (!flags.json.empty())
    write_atomically(flags.json, to_json(report).dump(1) + "\n");
}

void check(const GateFlags& flags) {
  if (flags.baseline.empty() && flags.against.empty())
    throw UsageError(
        "gate needs --baseline=FILE (see 'baseline') or --against=PROGRAM");
  if (flags.baseline.empty() && (flags.update || !flags.results.empty()))
    throw UsageError("--update and --results need --baseline=FILE");
  if (flags.update && !flags.results.empty())
    throw UsageError("--update runs the cases, so it excludes --results");
}

}  // namespace

ExitCode gate_verb(const Arguments& arguments) {
  GateFlags flags;
  if (!parse("gate",
             "Runs the cases of a baseline and compares each stage with it: "
             "bits if compiler, flags and libraries are the baseline's, "
             "otherwise stable digits. Exit 5 if a stage is worse or missing, "
             "6 if it is slower.",
             flags.flags(),
             arguments))
    return ExitCode::good;
  check(flags);
  if (!flags.against.empty()) program_in("--against", flags.against);
  head_of(flags);
  GateReport report;
  Chosen chosen{.profile = flags.profile.empty() ? "smoke" : flags.profile};
  std::vector<Case> cases;
  std::optional<AgainstBaseline> gate;
  if (!flags.baseline.empty()) {
    gate.emplace(flags);
    gate->judge_stages(report);
    gate->judge_instructions(report);
    chosen = gate->before().chosen;
    cases = gate->cases();
  } else {
    Selection selection;
    selection.filters = flags.filters;
    selection.plain = true;
    selection.profile = chosen.profile;
    cases = selection.cases();
  }
  if (!flags.against.empty()) judge_clock(flags, chosen, cases, report);
  tell(report, flags);
  if (flags.update) {
    gate->renew();
    return ExitCode::good;
  }
  if (report.code() != ExitCode::good)
    throw ExitError(report.code(),
                    fmt::format("the gate failed: {}", summary_text(report)));
  return ExitCode::good;
}

}  // namespace physinv
