#include "suite/results/merge.h"

#include <fmt/format.h>

#include "suite/app/options.h"

namespace physinv {

ExitCode merge_verb(const Arguments& arguments) {
  CLI::App app(
      "Joins the results of shards into what an unsharded run gives, times "
      "apart.",
      "physinv-bench merge");
  std::string out;
  std::vector<std::string> shards;
  app.add_option("OUT", out, "directory to write")->required();
  app.add_option("SHARD", shards, "directories that 'run' wrote")->required();
  if (!parse(app, arguments)) return ExitCode::good;
  std::vector<std::filesystem::path> paths;
  for (const auto& s : shards) paths.push_back(results_directory(s));
  merge(paths, out);
  fmt::print("merged {} into {}\n", shards.size(), out);
  return ExitCode::good;
}

}  // namespace physinv
