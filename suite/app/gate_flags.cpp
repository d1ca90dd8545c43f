#include "suite/app/gate_flags.h"

#include "suite/app/installed.h"
#include "suite/app/options.h"
#include "suite/harness/context.h"
#include "suite/harness/registry_errors.h"
#include "suite/harness/select.h"

namespace physinv {

std::vector<Flag> GateFlags::flags() {
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
      {"--filter",
       "of the cases: regular expressions, as the --filter of 'run' that are "
       "no words",
       &filters,
       "REGEX"},
      {"--profile",
       "the baseline's; without a baseline smoke",
       &profile,
       "NAME"},
      {"--results",
       "judge this campaign, run with --trace, instead of running one",
       &results,
       "DIR"},
      {"--out", "where to run; default: results/gate", &out, "DIR"},
      {"-j,--jobs", "worker processes; default: cores", &jobs},
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
      {"--strict", "what could not be decided ends with exit code 8", &strict},
      {"--update",
       "renew the baseline's lines of these cases and print what changed",
       &update},
      {"--json", "the findings as JSON", &json, "FILE"}};
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
