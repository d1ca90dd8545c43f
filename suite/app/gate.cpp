#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>

#include "suite/app/against_baseline.h"
#include "suite/app/options.h"
#include "suite/gate/gate_report.h"
#include "suite/gate/paired_timing.h"
#include "suite/harness/context.h"
#include "suite/harness/progress.h"
#include "suite/store/file.h"

namespace physinv {
namespace {

/// A program, or a build directory with one.
std::filesystem::path program_in(const std::string& flag,
                                 const std::string& text) {
  std::filesystem::path path(text);
  if (is_folder(path)) path /= "physinv-bench";
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
    report.notes.push_back(
        fmt::format("{} of {} cases are not in both programs: not timed",
                    cases.size() - options.cases.size(),
                    cases.size()));
  const PairedTiming timing = time_in_pairs(
      options, timed_run(options), [](std::size_t pair, std::size_t left) {
        fmt::print("pair {}: {} cases undecided\n", pair, left);
      });
  const std::size_t pairs =
      *std::max_element(timing.pairs.begin(), timing.pairs.end());
  report.notes.push_back(
      fmt::format("by the clock against {}: {} pairs in {}, order from seed {}",
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
    throw UsageError("--update runs the cases; it goes without --results");
}

}  // namespace

ExitCode gate_verb(const Arguments& arguments) {
  GateFlags flags;
  if (!parse(
          "gate",
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
                    fmt::format("the gate is shut: {}", summary_text(report)));
  return ExitCode::good;
}

}  // namespace physinv
