#include <nlohmann/json.hpp>

#include "suite/results/exports.h"
#include "tests/fuzz/inputs.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {

void repetitions(std::string_view bytes) {
  static const auto results = nlohmann::ordered_json::parse(R"({"benchmarks": [
      {"name": "fake/cubic/descend/n=4/seed=0/solve", "iterations": 10,
       "family_index": 0, "per_family_instance_index": 0, "threads": 1,
       "run_name": "fake/cubic/descend/n=4/seed=0/solve", "time_unit": "ms",
       "real_time": 0.5, "cpu_time": 0.25, "loss_median": 1e-3, "forward": 4,
       "vjp": 4, "jacobian": 0, "inverse": 0,
       "physinv": {"key": "0123456789abcdef0123456789abcdef"}}]})");
  const auto path = put("repetitions/repetitions.json", bytes);
  documented([&] {
    const Repetitions all = read_repetitions(path.parent_path());
    benchmark_csv(benchmark_json(results, all));
    smaller_is_better(results, all);
    bencher_metrics(results, all);
  });
}

}  // namespace physinv::fuzz
