#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "suite/app/gate_flags.h"
#include "suite/app/load.h"
#include "suite/app/options.h"
#include "suite/gate/duel.h"
#include "suite/gate/instructions.h"
#include "suite/gate/measure.h"
#include "suite/gate/sheet.h"
#include "suite/harness/context.h"
#include "suite/results/file.h"

namespace physinv {
namespace {

struct GateFlags {
  std::string baseline, profile, results, against, head, out = "results/gate",
                                                         json;
  std::vector<std::string> filters;
  int jobs = 0, seed = 1;
  double budget = 300, within = 2;
  bool allow_work = false, count = true, strict = false, update = false;

  std::vector<Flag> flags() {
    return {
        {"--baseline", "what 'baseline' wrote", &baseline, "FILE"},
        {"--against",
         "another physinv-bench, or its build directory: compare times by the "
         "clock",
         &against,
         "PROGRAM"},
        {"--head",
         "what --against is compared with; default: this program",
         &head,
         "PROGRAM"},
        {"--filter", "of the cases, as for 'run'", &filters, "REGEX"},
        {"--profile",
         "the baseline's; without a baseline smoke",
         &profile,
         "NAME"},
        {"--results",
         "judge this campaign, run with --trace, instead of running one",
         &results,
         "DIR"},
        {"--out", "where to run; default: results/gate", &out, "DIR"},
        {"--jobs", "worker processes; default: cores", &jobs},
        {"--allow-work", "counters of work may grow", &allow_work},
        {"--count,!--no-count",
         "count instructions where the baseline has them (default)",
         &count},
        {"--budget", "of --against; default: 300 seconds", &budget, "SECONDS"},
        {"--within",
         "what --against takes for equal; default: 2 percent",
         &within,
         "PERCENT"},
        {"--seed", "of the order of --against's pairs; default: 1", &seed},
        {"--strict",
         "what could not be decided ends with exit code 8",
         &strict},
        {"--update",
         "renew the baseline's lines of these cases and print what changed",
         &update},
        {"--json", "the findings as JSON", &json, "FILE"}};
  }

  MeasureOptions measuring() const {
    return {.out = out, .jobs = jobs_or_cores(jobs)};
  }
};

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

/// The baseline in front of the gate, and what was found now.
class Gate {
 public:
  explicit Gate(const GateFlags& flags)
      : flags_(flags),
        filter_(flags.filters),
        before_(read_baseline(flags.baseline)) {
    if (!flags.profile.empty() && flags.profile != before_.chosen.profile)
      throw UsageError(fmt::format("{} is of profile {}, not {}",
                                   flags.baseline,
                                   before_.chosen.profile,
                                   flags.profile));
    cases_ = cases_of(before_.chosen, flags.filters);
    lines_ = matching(before_.stages, filter_);
    require_something();
  }

  void judge_stages(Sheet& sheet) {
    now_ =
        flags_.results.empty()
            ? measure(cases_, flags_.measuring(), Screen::of(stdout))
            : matching(lines_of(load(flags_.results).results.cases()), filter_);
    const Rules rules{.bits = same_build(), .allow_work = flags_.allow_work};
    if (!rules.bits)
      sheet.notes.push_back(fmt::format(
          "{} is from another build ({}): judged within its stable digits",
          flags_.baseline,
          before_.build));
    for (const auto& j : judge(lines_, now_, rules))
      sheet.findings.push_back(finding_of(j));
  }

  void judge_instructions(Sheet& sheet) {
    const auto lines = countable();
    if (lines.empty() || !flags_.count) return;
    const auto counting = before_.counts.counter == counter_name(Counting::perf)
                              ? Counting::perf
                              : Counting::callgrind;
    std::string why = "the baseline is from another build";
    if (!same_build() || !can_count(counting, counting_program(), &why)) {
      sheet.findings.push_back(
          {.kind = "instructions",
           .name = fmt::format("{} cases", lines.size()),
           .verdict = "not counted",
           .detail = why,
           .code = flags_.strict ? ExitCode::inconclusive : ExitCode::good,
           .numbers = nullptr});
      return;
    }
    std::vector<std::string> names;
    for (const auto& line : lines) names.push_back(line.name);
    counts_ = count_instructions(
        counting, counting_program(), before_.chosen.profile, names);
    for (std::size_t i = 0; i < lines.size(); ++i)
      sheet.findings.push_back(judge(lines[i], counts_.lines[i]));
  }

  /// The new lines in the place of the old ones; what is gone goes.
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
    write_atomically(flags_.baseline, to_text(renewed));
    fmt::print(
        "renewed {}: {} stages\n", flags_.baseline, renewed.stages.size());
  }

  const Baseline& before() const { return before_; }
  const std::vector<Case>& cases() const { return cases_; }

 private:
  bool same_build() const { return before_.build == build_text(); }

  /// Nothing passes because nothing was judged.
  void require_something() const {
    if (!lines_.empty()) return;
    std::vector<std::string> names;
    for (const auto& line : before_.stages) names.push_back(case_of(line.name));
    std::string asked;
    for (const auto& f : flags_.filters)
      asked += (asked.empty() ? "" : " ") + f;
    const auto near = nearest_names(names, asked);
    throw ExitError(ExitCode::nothing_matched,
                    fmt::format("no case of {} matches '{}'; nearest is {}",
                                flags_.baseline,
                                asked,
                                near.empty() ? names.front() : near.front()));
  }

  /// Of cases that are gone, their stages tell.
  std::vector<CountLine> countable() const {
    std::set<std::string> known;
    for (const Case& c : cases_) known.insert(c.info.name);
    auto lines = matching(before_.counts.lines, filter_);
    std::erase_if(lines,
                  [&](const auto& line) { return !known.contains(line.name); });
    return lines;
  }

  CountTable renewed_counts() const {
    CountTable table = before_.counts;
    for (CountLine& line : table.lines)
      for (const CountLine& now : counts_.lines)
        if (now.name == line.name) line = now;
    std::set<std::string> registered;
    for (const Case& c : cases_of(before_.chosen))
      registered.insert(c.info.name);
    std::erase_if(table.lines, [&](const auto& line) {
      return !registered.contains(line.name);
    });
    return table;
  }

  const GateFlags& flags_;
  NameFilter filter_;
  Baseline before_;
  std::vector<Case> cases_;
  std::vector<StageLine> lines_, now_;
  CountTable counts_;
};

/// A program, or a build directory with one.
std::filesystem::path program_in(const std::string& flag,
                                 const std::string& text) {
  std::filesystem::path path(text);
  if (std::filesystem::is_directory(path)) path /= "physinv-bench";
  if (access(path.c_str(), X_OK) != 0)
    throw UsageError(fmt::format(
        "{}={} is no program; a physinv-bench or a directory with one is",
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
                 Sheet& sheet) {
  DuelOptions options{.base = program_in("--against", flags.against),
                      .head = head_of(flags),
                      .chosen = chosen,
                      .cases = {},
                      .out = flags.out + "/pair",
                      .seconds = flags.budget,
                      .margin = flags.within / 100,
                      .seed = static_cast<std::uint64_t>(flags.seed)};
  for (const Case& c : cases) options.cases.push_back(c.info.name);
  const Duel duel = fight(
      options, timed_run(options), [](std::size_t pair, std::size_t left) {
        fmt::print("pair {}: {} cases undecided\n", pair, left);
      });
  const std::size_t pairs =
      *std::max_element(duel.pairs.begin(), duel.pairs.end());
  sheet.notes.push_back(
      fmt::format("by the clock against {}: {} pairs in {}, order from seed {}",
                  options.base.string(),
                  pairs,
                  duration_text(duel.seconds),
                  options.seed));
  for (auto& finding : findings_of(options, duel, flags.strict))
    sheet.findings.push_back(std::move(finding));
}

/// For GITHUB_STEP_SUMMARY, which several steps write to.
void append(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::app);
  if (!(file << text << std::flush))
    throw EnvironmentError("cannot write " + path);
}

void tell(const Sheet& sheet, const GateFlags& flags) {
  fmt::print("{}", terminal_text(sheet));
  if (std::getenv("GITHUB_ACTIONS") != nullptr)
    fmt::print("{}", annotations(sheet));
  if (const char* path = std::getenv("GITHUB_STEP_SUMMARY"); path != nullptr)
    append(path, markdown_text(sheet));
  if (!flags.json.empty())
    write_atomically(flags.json, to_json(sheet).dump(1) + "\n");
}

void check(const GateFlags& flags) {
  if (flags.baseline.empty() && flags.against.empty())
    throw UsageError(
        "gate needs --baseline=FILE (see 'baseline') or --against=PROGRAM");
  if (flags.baseline.empty() && (flags.update || !flags.results.empty()))
    throw UsageError("--update and --results need --baseline=FILE");
  if (flags.update && !flags.results.empty())
    throw UsageError("--update runs the cases; it goes without --results");
}

}  // namespace

ExitCode gate_verb(const Arguments& arguments) {
  GateFlags flags;
  if (!parse(
          "physinv-bench gate",
          "Runs the cases of a baseline and holds each stage against it: the "
          "same bits where compiler, flags and libraries are the baseline's, "
          "elsewhere its stable digits. Exit 5 if a stage is worse or missing, "
          "6 if it is slower.",
          flags.flags(),
          arguments))
    return ExitCode::good;
  check(flags);
  if (!flags.against.empty()) program_in("--against", flags.against);
  head_of(flags);
  Sheet sheet;
  Chosen chosen{.profile = flags.profile.empty() ? "smoke" : flags.profile};
  std::vector<Case> cases;
  std::optional<Gate> gate;
  if (!flags.baseline.empty()) {
    gate.emplace(flags);
    gate->judge_stages(sheet);
    gate->judge_instructions(sheet);
    chosen = gate->before().chosen;
    cases = gate->cases();
  } else {
    Selection selection;
    selection.filters = flags.filters;
    selection.profile = chosen.profile;
    cases = selection.cases();
  }
  if (!flags.against.empty()) judge_clock(flags, chosen, cases, sheet);
  tell(sheet, flags);
  if (flags.update) {
    gate->renew();
    return ExitCode::good;
  }
  if (sheet.code() != ExitCode::good)
    throw ExitError(sheet.code(),
                    fmt::format("the gate is shut: {}", summary_text(sheet)));
  return ExitCode::good;
}

}  // namespace physinv
