#include "suite/evidence/training_report.h"

#include <fmt/format.h>

namespace physinv {
namespace {

/// A finished chain of training stages; null if it is not there.
const CaseRecord* trained_case(const Results& results,
                               std::string_view experiment,
                               std::string_view method,
                               std::uint64_t seed) {
  for (const Index n : results.sizes(experiment)) {
    const CaseRecord* c = results.find_case(experiment, method, n, seed);
    if (c == nullptr || c->stages.size() != c->info.stages.size()) continue;
    if (c->stages.back().arrays.contains("mean_loss")) return c;
  }
  return nullptr;
}

}  // namespace

std::vector<const CaseRecord*> trained_chains(const Results& results,
                                              std::string_view experiment,
                                              std::string_view method) {
  std::vector<const CaseRecord*> found;
  for (const std::uint64_t seed : results.seeds(experiment))
    if (const auto* c = trained_case(results, experiment, method, seed))
      found.push_back(c);
  return found;
}

std::vector<const StageRecord*> trained_stages(const Results& results,
                                               std::string_view experiment,
                                               std::string_view method) {
  std::vector<const StageRecord*> found;
  for (const CaseRecord* c : trained_chains(results, experiment, method))
    found.push_back(&c->stages.back());
  return found;
}

std::optional<double> paper_update(const Published& published,
                                   std::string_view experiment,
                                   std::string_view row) {
  const auto found = published.find(experiment, fmt::format("{}/update", row));
  return found ? std::optional(found->value) : std::nullopt;
}

}  // namespace physinv
