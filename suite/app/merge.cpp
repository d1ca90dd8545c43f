#include "suite/results/merge.h"

#include <fmt/format.h>

#include "suite/app/options.h"

namespace physinv {

ExitCode merge_verb(const Arguments& arguments) {
  std::string out;
  std::vector<std::string> shards;
  if (!parse("physinv-bench merge",
             "Joins the results of shards into what an unsharded run gives, "
             "times apart.",
             {{"OUT", "directory to write", &out},
              {"SHARD", "directories that 'run' wrote", &shards}},
             arguments))
    return ExitCode::good;
  std::vector<std::filesystem::path> paths;
  for (const auto& s : shards) paths.push_back(results_directory(s));
  merge(paths, out);
  fmt::print("merged {} into {}\n", shards.size(), out);
  return ExitCode::good;
}

}  // namespace physinv
