#include "suite/harness/verify.h"

#include <fmt/format.h>

#include <algorithm>

#include "suite/app/load.h"
#include "suite/app/options.h"

namespace physinv {
namespace {

void print(const VerifyReport& r, const MissingWork& lacks) {
  fmt::print(
      "{} losses of {} of {} stages: {} bitwise equal, {} within {:g}, {} "
      "within {:g} by plain loops through the network, {} mismatches\n",
      r.losses,
      r.stages,
      lacks.stages,
      r.bitwise,
      r.close,
      kVerifyTolerance,
      r.by_network,
      kPlainTolerance,
      r.mismatches.size());
  if (r.not_again > 0)
    fmt::print(
        "not verified: {} losses whose solution is not stored and whose "
        "network has no plain loops\n",
        r.not_again);
  for (const auto& name : r.unknown)
    fmt::print("not verified: this program does not have {}\n", name);
  for (std::size_t i = 0; i < std::min<std::size_t>(10, r.mismatches.size());
       ++i)
    fmt::print("  {}\n", r.mismatches[i]);
}

}  // namespace

ExitCode verify_verb(const Arguments& arguments) {
  std::string directory;
  if (!parse("verify",
             "Recomputes every final loss from the stored solutions, one "
             "example at a time in double, and compares bitwise or within "
             "1e-12 relative. Solutions that are not stored are recomputed "
             "from the network's parameters by plain loops, and compared "
             "within 1e-9. Exit 4 if one differs, 10 if stages are missing.",
             {{"RESULTS", "directory that 'run' wrote", &directory}},
             arguments))
    return ExitCode::good;
  const Loaded loaded = load(directory);
  const VerifyReport r = verify_results(loaded.results, registry());
  print(r, loaded.lacks);
  if (!r.mismatches.empty())
    throw ExitError(ExitCode::case_failed,
                    fmt::format("{} recorded losses are wrong, first {}; the "
                                "results or the physics changed",
                                r.mismatches.size(),
                                r.mismatches.front()));
  require_complete(loaded.lacks,
                   "repeat the same 'run' command; it reuses finished stages");
  if (r.stages == 0 && r.unknown.empty())
    throw ExitError(ExitCode::nothing_matched,
                    "nothing to verify in '" + directory + "'");
  if (!r.unknown.empty())
    throw ExitError(ExitCode::incomplete,
                    fmt::format("incomplete: this program does not have {}; "
                                "verify with the program that ran it",
                                r.unknown.front()));
  return ExitCode::good;
}

}  // namespace physinv
