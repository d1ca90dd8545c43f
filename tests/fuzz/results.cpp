#include <nlohmann/json.hpp>

#include "suite/results/exports.h"
#include "suite/store/results_file.h"
#include "suite/store/results_json.h"
#include "tests/fuzz/inputs.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {

void results(std::string_view bytes) {
  documented([&] {
    const auto all = parse_results(bytes, "results.json");
    if (results_version(all) < kResultsVersion) return;
    benchmark_csv(benchmark_json(all));
    smaller_is_better(all);
    bencher_metrics(all);
  });
}

}  // namespace physinv::fuzz
