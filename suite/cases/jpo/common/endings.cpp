#include "suite/cases/jpo/common/endings.h"

namespace physinv {

Endings::Endings(const JpoMetrics& metrics,
                 std::string_view method,
                 bool refined,
                 Index first) {
  for (const Index n : sizes_between(metrics, first, 1 << 30))
    for (const std::uint64_t seed : metrics.seeds())
      if (const auto* end = metrics.ending(method, n, seed, refined))
        found_.push_back(end);
}

std::vector<double> Endings::all(Vector<double> StageRecord::*row) const {
  std::vector<double> out;
  for (const StageRecord* s : found_)
    out.insert(out.end(), (s->*row).begin(), (s->*row).end());
  return out;
}

std::optional<double> Endings::median_iterations() const {
  const auto values = all(&StageRecord::example_iterations);
  if (values.empty()) return {};
  return median(values);
}

double mean_loss(const StageRecord& s) { return s.loss.mean(); }

double median_loss(const StageRecord& s) {
  return median({s.loss.begin(), s.loss.end()});
}

bool full_training(const Results& results, std::string_view experiment) {
  const auto& cases = results.cases();
  return std::none_of(cases.begin(), cases.end(), [&](const CaseRecord& c) {
    return c.info.experiment == experiment && c.info.profile == "smoke";
  });
}

}  // namespace physinv
