#include "suite/cases/hig/poisson/runs.h"

#include <algorithm>

#include "optimizers/half_inverse/half_inverse.h"
#include "suite/cases/jpo/common/endings.h"

namespace physinv::poisson {
namespace {

constexpr Index kCells = 64;

std::string last_stage(const Results& results, std::string_view method) {
  for (const CaseRecord& c : results.cases())
    if (c.info.experiment == kName && c.info.method == method)
      return c.info.stages.back();
  return {};
}

/// The smallest of the singular values that are known.
double smallest_of(const StageRecord& stage) {
  const auto &path = stage.arrays.at("path"), &s = stage.arrays.at("smallest");
  double smallest = std::numeric_limits<double>::infinity();
  // A Cholesky factorisation has only a lower bound.
  for (Index k = 0; k < path.size(); ++k)
    if (path(k) != static_cast<double>(hig::Path::shortcut))
      smallest = std::min(smallest, s(k));
  return smallest;
}

void add(const StageRecord& stage, Phase& phase) {
  const auto& kept = stage.arrays.at("kept");
  if (kept.size() == 0) return;
  for (const auto& [name, value] : stage.options)
    if (name == "batch") phase.rows = kCells * std::stoll(value);
  const auto least = static_cast<Index>(kept.minCoeff());
  phase.least_kept =
      phase.runs == 0 ? least : std::min(phase.least_kept, least);
  ++phase.runs;
  phase.updates += kept.size();
  phase.unproven += static_cast<Index>(stage.arrays.at("unproven")(0, 0));
  phase.smallest = std::min(phase.smallest, smallest_of(stage));
}

}  // namespace

const StageRecord* Runs::one(std::string_view method,
                             std::string_view stage,
                             std::uint64_t seed) const {
  for (const Index n : results_.sizes(kName)) {
    const auto* s = results_.find(kName, method, n, seed, stage);
    if (s != nullptr && s->arrays.contains("mean_loss")) return s;
  }
  return nullptr;
}

std::vector<const StageRecord*> Runs::all(std::string_view method,
                                          std::string_view stage) const {
  std::vector<const StageRecord*> found;
  for (const std::uint64_t seed : results_.seeds(kName))
    if (const auto* s = one(method, stage, seed)) found.push_back(s);
  return found;
}

std::optional<double> Runs::median_of(std::string_view method,
                                      std::string_view stage,
                                      const Value& value) const {
  std::vector<double> values;
  for (const StageRecord* s : all(method, stage))
    if (const auto v = value(*s)) values.push_back(*v);
  if (values.empty()) return {};
  return median(values);
}

std::optional<double> Runs::loss(std::string_view method,
                                 double updates) const {
  return median_of(method, last_stage(results_, method), [&](const auto& s) {
    return loss_at(s, updates);
  });
}

std::optional<double> Runs::median_of_pairs(std::string_view method,
                                            std::string_view stage,
                                            std::string_view other_method,
                                            std::string_view other_stage,
                                            const Pair& value) const {
  std::vector<double> values;
  for (const std::uint64_t seed : results_.seeds(kName)) {
    const auto* a = one(method, stage, seed);
    const auto* b = one(other_method, other_stage, seed);
    if (a == nullptr || b == nullptr) continue;
    if (const auto v = value(*a, *b)) values.push_back(*v);
  }
  if (values.empty()) return {};
  return median(values);
}

std::vector<Phase> phases(const Runs& runs) {
  std::vector<Phase> found;
  for (const std::string& method : runs.results().methods(kName)) {
    for (const StageRecord* stage : runs.all(method, "hig")) {
      if (!stage->arrays.contains("kept")) continue;
      if (found.empty() || found.back().method != method)
        found.push_back({.method = method});
      add(*stage, found.back());
    }
  }
  return found;
}

}  // namespace physinv::poisson
