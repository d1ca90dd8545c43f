#include "suite/cases/hig/poisson/quantities.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "optimizers/half_inverse/half_inverse.h"
#include "suite/core/whole.h"
#include "suite/evidence/options.h"
#include "suite/results/results.h"
#include "suite/store/record.h"

namespace physinv::hig::poisson {
namespace {

constexpr Index kCells = 64;

/// The smallest of the singular values that are known.
double smallest_of(const StageRecord& stage) {
  const auto &path = stage.arrays.at("path"), &s = stage.arrays.at("smallest");
  double smallest = std::numeric_limits<double>::infinity();
  for (Index k = 0; k < path.size(); ++k)
    if (path(k) != static_cast<double>(hig::Path::shortcut))
      smallest = std::min(smallest, s(k));
  return smallest;
}

void add(const StageRecord& stage, Phase& phase) {
  const auto& kept = stage.arrays.at("kept");
  if (const auto batch = number_of(stage.options, "batch"))
    phase.rows = kCells * whole_part<Index>(*batch);
  const auto least = whole_part<Index>(kept.minCoeff());
  phase.least_kept =
      phase.runs == 0 ? least : std::min(phase.least_kept, least);
  ++phase.runs;
  phase.updates += kept.size();
  phase.unproven += whole_part<Index>(stage.arrays.at("unproven")(0, 0));
  phase.smallest = std::min(phase.smallest, smallest_of(stage));
}

}  // namespace

std::vector<Phase> phases(const Evidence& e) {
  std::vector<Phase> found;
  for (const std::string& method : e.results.methods(e.experiment)) {
    Phase phase{.method = method};
    for (const CaseRecord& c : e.results.cases()) {
      if (c.info.experiment != e.experiment || c.info.method != method)
        continue;
      for (const StageRecord& s : c.stages)
        if (s.arrays.contains("kept") && s.arrays.at("kept").size() > 0)
          add(s, phase);
    }
    if (phase.runs > 0) found.push_back(std::move(phase));
  }
  return found;
}

}  // namespace physinv::hig::poisson
