#include "suite/app/gate_flags.h"

#include "suite/app/installed.h"
#include "suite/app/options.h"
#include "suite/harness/context.h"
#include "suite/harness/registry_errors.h"
#include "suite/harness/select.h"

namespace physinv {

std::vector<Flag> GateFlags::flags() {
  return {
      {"--baseline", "file that 'baseline' wrote", &baseline, "FILE"},
      {"--against",
       "another physinv-bench or its build directory, to compare measured "
       "times with",
       &against,
       "PROGRAM"},
      {"--head",
       "program that is compared with --against; default: this program",
       &head,
       "PROGRAM"},
      {"--filter",
       "regular expressions that select cases; words are not treated specially "
       "as by 'run'",
       &filters,
       "REGEX"},
      {"--profile",
       "profile; default: the baseline's, or smoke without a baseline",
       &profile,
       "NAME"},
      {"--results",
       "judge this campaign, run with --trace, instead of running one",
       &results,
       "DIR"},
      {"--out", "directory of the run; default: results/gate", &out, "DIR"},
      {"-j,--jobs", "worker processes; default: cores", &jobs},
      {"--allow-work", "allow counters of work to grow", &allow_work},
      {"--count,!--no-count",
       "count instructions where the baseline has them (default)",
       &count},
      {"--budget",
       "time budget of --against; default: 300 seconds",
       &budget,
       "SECONDS"},
      {"--within",
       "difference that --against treats as equal; default: 2 percent",
       &within,
       "PERCENT"},
      {"--seed", "seed for the order of --against's pairs; default: 1", &seed},
      {"--strict",
       "exit with code 8 if something could not be decided",
       &strict},
      {"--update",
       "renew the baseline's lines of these cases and print what changed",
       &update},
      {"--json", "write the findings as JSON", &json, "FILE"}};
}

MeasureOptions GateFlags::measuring() const {
  return {.out = out, .jobs = jobs_or_cores(jobs)};
}

std::vector<Case> cases_of(const Chosen& chosen,
                           const std::vector<std::string>& filters,
                           const std::string& whose) {
  auto all = registry().expand(chosen.profile,
                               parse_overrides(chosen.sets, chosen.seeds));
  auto cases = NameFilter(filters).apply(
      NameFilter(chosen.filters, whose).apply(std::move(all)));
  validate(registry(), cases);
  return cases;
}

int jobs_or_cores(int jobs) { return jobs > 0 ? jobs : available_cores(); }

std::filesystem::path counting_program() {
  const std::filesystem::path named = variable("PHYSINV_COUNT");
  return named.empty() ? program_directory() / "physinv-count" : named;
}

}  // namespace physinv
