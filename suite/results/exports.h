/// results.json for other programs. What failed, was skipped, diverged or was
/// not run is an error in each of them, without a time: a series that ends, or
/// falls to zero, raises no alarm. Where dashboards get losses, a median that
/// is not finite is an error, too.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace physinv {

class Catalog;
struct MissingWork;

struct StageName {
  std::string case_name;
  std::string stage;  ///< empty where a plan of an older version names none
};
/// Stages that were asked for and have no record.
std::vector<StageName> stages_not_run(const Catalog& catalog,
                                      const MissingWork& lacks);

/// An error for each.
void add_not_run(nlohmann::ordered_json& results,
                 const std::vector<StageName>& names);

/// Google Benchmark's JSON: `results` as results.json has it, an entry for
/// each repetition, and mean, median, stddev and cv of what was repeated.
nlohmann::ordered_json benchmark_json(nlohmann::ordered_json results);

/// Google Benchmark's CSV of the same.
std::string benchmark_csv(const nlohmann::ordered_json& benchmarks);

/// github-action-benchmark's customSmallerIsBetter: of each stage `error`, 0 or
/// 1, time of solving, the median of repetitions with their range, and median
/// loss. The service compares with the commit before: 1 after 0 is an alert.
nlohmann::ordered_json smaller_is_better(const nlohmann::ordered_json& results);

/// Bencher Metric Format: error, latency in nanoseconds, loss, simulations. A
/// threshold of error that alerts is static, with an upper boundary of 0.
nlohmann::ordered_json bencher_metrics(const nlohmann::ordered_json& results);

}  // namespace physinv
