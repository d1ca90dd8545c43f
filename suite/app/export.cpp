#include "suite/app/export.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "suite/app/load.h"
#include "suite/app/options.h"
#include "suite/results/exports.h"
#include "suite/results/folder.h"
#include "suite/results/results_json.h"

namespace physinv {
namespace {

std::string text_in(const std::string& format,
                    const nlohmann::ordered_json& results,
                    const Repetitions& repetitions) {
  if (format == "json")
    return benchmark_json(results, repetitions).dump(1) + "\n";
  if (format == "csv")
    return benchmark_csv(benchmark_json(results, repetitions));
  if (format == "github")
    return smaller_is_better(results, repetitions).dump(1) + "\n";
  if (format == "bencher")
    return bencher_metrics(results, repetitions).dump(1) + "\n";
  throw UsageError(fmt::format(
      "--format={} is unknown; known are json, csv, github, bencher", format));
}

}  // namespace

std::string exported(const std::string& directory, const std::string& format) {
  const std::filesystem::path from = results_directory(directory);
  if (!Folder(from).has("results.json"))
    throw UsageError(fmt::format(
        "'{}' holds no results.json; 'run' and 'merge' write one", directory));
  return text_in(format, read_results(from), read_repetitions(from));
}

ExitCode export_verb(const Arguments& arguments) {
  std::string directory, format = "json", out;
  if (!parse(
          "export",
          "Results for dashboards, with the spread of repetitions "
          "(run --benchmark_repetitions).",
          {{"RESULTS", "directory that 'run' wrote", &directory},
           {"--format",
            "json or csv (Google Benchmark's), github (customSmallerIsBetter "
            "of github-action-benchmark), bencher (Bencher Metric Format)",
            &format,
            "FORMAT"},
           {"--out", "default: standard output", &out, "FILE"}},
          arguments))
    return ExitCode::good;
  const std::string text = exported(directory, format);
  if (out.empty()) {
    fmt::print("{}", text);
  } else {
    write_atomically(out, text);
  }
  return ExitCode::good;
}

}  // namespace physinv
