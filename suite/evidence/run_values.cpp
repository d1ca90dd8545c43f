#include "suite/evidence/run_values.h"

#include <optional>
#include <utility>

#include "suite/store/record.h"

namespace physinv {
namespace {

std::vector<double> list(const Vector<double>& v) {
  return {v.begin(), v.end()};
}

}  // namespace

RunValue of_array(ArrayKey name,
                  std::function<double(const Batch<double>&)> value) {
  return [=](const Run& run) -> std::optional<double> {
    const auto found = run.stage->arrays.find(name);
    if (found == run.stage->arrays.end()) return {};
    return value(found->second);
  };
}

RunRow losses() {
  return [](const Run& run) { return list(run.stage->loss); };
}
RunRow iterations() {
  return [](const Run& run) { return list(run.stage->example_iterations); };
}
RunRow evaluations() {
  return [](const Run& run) { return list(run.stage->example_evaluations); };
}

RunValue of_row(RunRow row, double (*statistic)(std::vector<double>)) {
  return [=](const Run& run) -> std::optional<double> {
    auto values = row(run);
    if (values.empty()) return {};
    return statistic(std::move(values));
  };
}

RunValue against(const Select& other, Share share, Equality equality) {
  return [=](const Run& run) -> std::optional<double> {
    const auto found = run.beside(other.in(run.record->info.experiment));
    if (!found) return {};
    return share(compare_losses(run.stage->loss, found->stage->loss, equality));
  };
}

}  // namespace physinv
