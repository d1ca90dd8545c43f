#include "suite/store/merge.h"

#include <fmt/format.h>

#include "suite/app/load.h"
#include "suite/app/options.h"

namespace physinv {

ExitCode merge_verb(const Arguments& arguments) {
  std::string out;
  std::vector<std::string> shards;
  LockOptions lock;
  if (!parse("merge",
             "Merges the results of shards. The merged results equal those of "
             "an unsharded run, except for times.",
             {{"OUT", "directory to write", &out},
              {"SHARD", "directories that 'run' wrote", &shards},
              {"--break-lock",
               "same as for run, for the lock of OUT",
               &lock.break_lock}},
             arguments))
    return ExitCode::good;
  std::vector<std::filesystem::path> paths;
  for (const auto& s : shards) paths.push_back(results_directory(s));
  const Merged merged = merge(paths, out, lock);
  for (const auto& warning : merged.warnings)
    fmt::print("warning: {}\n", warning);
  fmt::print("merged {} into {}\n", shards.size(), out);
  require_complete(merged.lacks,
                   "run the missing cases, then merge all shards again");
  return ExitCode::good;
}

}  // namespace physinv
