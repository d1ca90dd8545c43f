#include "suite/harness/verify.h"

#include <fmt/format.h>

#include <algorithm>

#include "suite/app/options.h"
#include "suite/results/results.h"

namespace physinv {

ExitCode verify_verb(const Arguments& arguments) {
  std::string results;
  if (!parse("physinv-bench verify",
             "Recomputes every final loss from the stored solutions, one "
             "example at a time in double, and compares bitwise or within "
             "1e-12 relative.",
             {{"RESULTS", "directory that 'run' wrote", &results}},
             arguments))
    return ExitCode::good;
  const VerifyReport r =
      verify_results(load_results(results_directory(results)), registry());
  fmt::print(
      "{} losses of {} stages: {} bitwise equal, {} within {:g}, {} "
      "mismatches\n",
      r.losses,
      r.stages,
      r.bitwise,
      r.close,
      kVerifyTolerance,
      r.mismatches.size());
  for (const auto& name : r.unknown)
    fmt::print("not verified: this program does not know {}\n", name);
  for (std::size_t i = 0; i < std::min<std::size_t>(10, r.mismatches.size());
       ++i)
    fmt::print("  {}\n", r.mismatches[i]);
  if (!r.mismatches.empty())
    throw ExitError(ExitCode::case_failed,
                    fmt::format("{} recorded losses are wrong, first {}; the "
                                "results or the physics changed",
                                r.mismatches.size(),
                                r.mismatches.front()));
  if (r.stages == 0)
    throw ExitError(ExitCode::nothing_matched,
                    "there is nothing to verify in '" + results + "'");
  return ExitCode::good;
}

}  // namespace physinv
