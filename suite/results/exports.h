/// results.json and repeated times for other programs.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "suite/results/record.h"

namespace physinv {

/// Times of solving a stage again, by "case/stage key", so that those of other
/// options or sources count for nothing. The results of these runs were the
/// same and are not kept.
using Repetitions = std::map<std::string, std::vector<Seconds>>;

/// repetitions.json of a directory of results; empty if there is none.
Repetitions read_repetitions(const std::filesystem::path& directory);
/// The same of a file's bytes; `path` is for messages. StoreError if they are
/// damaged.
Repetitions parse_repetitions(std::string_view bytes,
                              const std::filesystem::path& path);
void write_repetitions(const std::filesystem::path& directory,
                       const Repetitions& repetitions);

/// Google Benchmark's JSON: `results` as results.json has it, an entry for
/// each repetition, and mean, median, stddev and cv of what was repeated.
nlohmann::ordered_json benchmark_json(nlohmann::ordered_json results,
                                      const Repetitions& repetitions);

/// Google Benchmark's CSV of the same.
std::string benchmark_csv(const nlohmann::ordered_json& benchmarks);

/// github-action-benchmark's customSmallerIsBetter: time of solving and median
/// loss of each stage, the median of repetitions with their range.
nlohmann::ordered_json smaller_is_better(const nlohmann::ordered_json& results,
                                         const Repetitions& repetitions);

/// Bencher Metric Format: latency in nanoseconds, loss, simulations.
nlohmann::ordered_json bencher_metrics(const nlohmann::ordered_json& results,
                                       const Repetitions& repetitions);

}  // namespace physinv
