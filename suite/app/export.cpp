#include "suite/app/export.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "suite/app/load.h"
#include "suite/app/options.h"
#include "suite/results/exports.h"
#include "suite/results/tidy.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

std::string text_in(const std::string& format, const Json& results) {
  if (format == "json") return benchmark_json(results).dump(1) + "\n";
  if (format == "csv") return benchmark_csv(benchmark_json(results));
  if (format == "github") return smaller_is_better(results).dump(1) + "\n";
  if (format == "bencher") return bencher_metrics(results).dump(1) + "\n";
  throw UsageError(fmt::format(
      "--format={} is unknown; known values: json, csv, tidy, github, bencher",
      format));
}

}  // namespace

std::string exported(const Loaded& loaded, const std::string& format) {
  if (format == "tidy")
    return tidy_csv(loaded.catalog, loaded.results.cases(), loaded.lacks);
  auto results = results_of(loaded);
  add_not_run(results, stages_not_run(loaded.catalog, loaded.lacks));
  return text_in(format, results);
}

ExitCode export_verb(const Arguments& arguments) {
  std::string directory, format = "json", out;
  if (!parse("export",
             "Converts results for dashboards and other programs, with the "
             "spread of repetitions (run --benchmark_repetitions). A stage "
             "that failed, was skipped, diverged or was not run has no time "
             "and no loss, but an error: error_occurred in json and csv; in "
             "github and bencher the measure error, which is 1 instead of 0; "
             "in tidy the status of each example. A stage whose cores were "
             "shared is marked as crowded: label in csv, extra in github, a "
             "measure in bencher, a column in tidy. Exit 10 if stages failed, "
             "were skipped or not run; the other stages are written.",
             {{"RESULTS", "directory that 'run' wrote", &directory},
              {"--format",
               "json or csv (Google Benchmark's), tidy (CSV, a row for every "
               "example of every stage), github (customSmallerIsBetter "
               "of github-action-benchmark), bencher (Bencher Metric Format)",
               &format,
               "FORMAT"},
              {"--out", "output file; default: standard output", &out, "FILE"}},
             arguments))
    return ExitCode::good;
  const Loaded loaded = load(directory, stderr);
  const std::string text = exported(loaded, format);
  if (out.empty()) {
    fmt::print("{}", text);
  } else {
    write_atomically(out, text);
  }
  require_complete(loaded.lacks, kRunAgain);
  return ExitCode::good;
}

}  // namespace physinv
