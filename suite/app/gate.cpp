#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "suite/app/gate_flags.h"
#include "suite/app/load.h"
#include "suite/app/options.h"
#include "suite/gate/measure.h"
#include "suite/gate/sheet.h"
#include "suite/harness/context.h"
#include "suite/results/file.h"

namespace physinv {
namespace {

struct GateFlags {
  std::string baseline, profile, results, out = "results/gate", json;
  std::vector<std::string> filters;
  int jobs = 0;
  bool allow_work = false, update = false;

  std::vector<Flag> flags() {
    return {{"--baseline", "what 'baseline' wrote", &baseline, "FILE"},
            {"--filter", "of its cases, as for 'run'", &filters, "REGEX"},
            {"--profile", "must be the baseline's", &profile, "NAME"},
            {"--results",
             "judge this campaign, run with --trace, instead of running one",
             &results,
             "DIR"},
            {"--out", "where to run; default: results/gate", &out, "DIR"},
            {"--jobs", "worker processes; default: cores", &jobs},
            {"--allow-work", "counters of work may grow", &allow_work},
            {"--update",
             "renew the baseline's lines of these cases and print what changed",
             &update},
            {"--json", "the findings as JSON", &json, "FILE"}};
  }
};

Baseline wanted(const GateFlags& flags) {
  if (flags.baseline.empty())
    throw UsageError("--baseline=FILE is missing; 'baseline' writes one");
  Baseline b = read_baseline(flags.baseline);
  if (!flags.profile.empty() && flags.profile != b.chosen.profile)
    throw UsageError(fmt::format("{} is of profile {}, not {}",
                                 flags.baseline,
                                 b.chosen.profile,
                                 flags.profile));
  return b;
}

/// Lines whose case matches.
std::vector<StageLine> matching(std::vector<StageLine> lines,
                                const NameFilter& filter) {
  std::erase_if(lines, [&](const StageLine& line) {
    return !filter.matches(case_of(line.name));
  });
  return lines;
}

std::vector<StageLine> lines_now(const GateFlags& flags,
                                 const std::vector<Case>& cases) {
  if (!flags.results.empty())
    return matching(lines_of(load(flags.results).results.cases()),
                    NameFilter(flags.filters));
  return measure(cases,
                 {.out = flags.out, .jobs = jobs_or_cores(flags.jobs)},
                 Screen::of(stdout));
}

/// Nothing passes because nothing was judged.
void require_something(const std::vector<StageLine>& lines,
                       const GateFlags& flags,
                       const Baseline& before) {
  if (!lines.empty()) return;
  std::vector<std::string> names;
  for (const auto& line : before.stages) names.push_back(case_of(line.name));
  std::string asked;
  for (const auto& f : flags.filters) asked += (asked.empty() ? "" : " ") + f;
  const auto near = nearest_names(names, asked);
  throw ExitError(ExitCode::nothing_matched,
                  fmt::format("no case of {} matches '{}'; nearest is {}",
                              flags.baseline,
                              asked,
                              near.empty() ? names.front() : near.front()));
}

/// The new lines in the place of the old ones, what is gone taken out.
void renew(const GateFlags& flags,
           const Baseline& before,
           const std::vector<Case>& cases,
           std::vector<StageLine> now) {
  measure_digits(now,
                 cases,
                 {.out = flags.out, .jobs = jobs_or_cores(flags.jobs)},
                 Screen::of(stdout));
  Baseline renewed = blank_baseline(before.chosen);
  renewed.counts = before.counts;
  const NameFilter filter(flags.filters);
  for (const auto& line : before.stages)
    if (!filter.matches(case_of(line.name))) renewed.stages.push_back(line);
  renewed.stages.insert(renewed.stages.end(), now.begin(), now.end());
  write_atomically(flags.baseline, to_text(renewed));
  fmt::print("renewed {}: {} stages\n", flags.baseline, renewed.stages.size());
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

}  // namespace

std::vector<Case> cases_of(const Chosen& chosen,
                           const std::vector<std::string>& filters) {
  registry().validate();
  auto all = registry().expand(chosen.profile,
                               parse_overrides(chosen.sets, chosen.seeds));
  return NameFilter(filters).apply(
      NameFilter(chosen.filters).apply(std::move(all)));
}

int jobs_or_cores(int jobs) { return jobs > 0 ? jobs : available_cores(); }

ExitCode gate_verb(const Arguments& arguments) {
  GateFlags flags;
  if (!parse("physinv-bench gate",
             "Runs the cases of a baseline and holds each stage against it. "
             "The same bits are asked for where compiler, flags and libraries "
             "are the baseline's, elsewhere its stable digits. Exit 5 if a "
             "stage is worse or missing.",
             flags.flags(),
             arguments))
    return ExitCode::good;
  const Baseline before = wanted(flags);
  const auto lines = matching(before.stages, NameFilter(flags.filters));
  require_something(lines, flags, before);
  const auto cases = cases_of(before.chosen, flags.filters);
  const auto now = lines_now(flags, cases);

  const Rules rules{.bits = before.build == build_text(),
                    .allow_work = flags.allow_work};
  Sheet sheet;
  if (!rules.bits)
    sheet.notes.push_back(fmt::format(
        "{} is from another build ({}): judged within its stable digits",
        flags.baseline,
        before.build));
  for (const auto& j : judge(lines, now, rules))
    sheet.findings.push_back(finding_of(j));
  tell(sheet, flags);
  if (flags.update) {
    renew(flags, before, cases, now);
    return ExitCode::good;
  }
  if (sheet.code() != ExitCode::good)
    throw ExitError(sheet.code(),
                    fmt::format("the gate is shut: {}", summary_text(sheet)));
  return ExitCode::good;
}

}  // namespace physinv
