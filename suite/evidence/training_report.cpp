#include "suite/evidence/training_report.h"

#include <fmt/format.h>

namespace physinv {
namespace {

/// A finished chain of training stages; null if it is not there.
const CaseRecord* trained_case(const Evidence& e,
                               std::string_view method,
                               std::uint64_t seed) {
  for (const Index n : e.results.sizes(e.experiment)) {
    const CaseRecord* c = e.results.find_case(e.experiment, method, n, seed);
    if (c == nullptr || c->stages.size() != c->info.stages.size()) continue;
    if (c->stages.back().arrays.contains("mean_loss")) return c;
  }
  return nullptr;
}

}  // namespace

std::vector<const CaseRecord*> trained_chains(const Evidence& e,
                                              std::string_view method) {
  std::vector<const CaseRecord*> found;
  for (const std::uint64_t seed : e.results.seeds(e.experiment))
    if (const auto* c = trained_case(e, method, seed)) found.push_back(c);
  return found;
}

std::vector<const StageRecord*> trained_stages(const Evidence& e,
                                               std::string_view method) {
  std::vector<const StageRecord*> found;
  for (const CaseRecord* c : trained_chains(e, method))
    found.push_back(&c->stages.back());
  return found;
}

std::optional<double> paper_update(const Evidence& e, std::string_view row) {
  const auto found =
      e.published.find(e.experiment, fmt::format("{}/update", row));
  return found ? std::optional(found->value) : std::nullopt;
}

}  // namespace physinv
