/// Planted training runs, and what a claim makes of them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "suite/harness/registry.h"
#include "suite/results/published.h"

namespace physinv {

/// One more point of the curve every ten updates and every second.
inline StageRecord trained(const std::string& name,
                           const std::vector<double>& loss) {
  StageRecord s;
  s.stage = name;
  for (std::size_t k = 0; k < loss.size(); ++k) {
    s.curve.iteration.push_back(10.0 * static_cast<double>(k));
    s.curve.seconds.push_back(static_cast<double>(k));
  }
  s.arrays["mean_loss"] = Eigen::Map<const Batch<double>>(
      loss.data(), 1, static_cast<Index>(loss.size()));
  s.iterations = 10 * (static_cast<Index>(loss.size()) - 1);
  return s;
}

/// A case of the largest profile.
inline CaseRecord chain(const std::string& experiment,
                        const std::string& method,
                        std::vector<StageRecord> stages,
                        std::uint64_t seed = 0) {
  CaseRecord c;
  c.info.experiment = experiment;
  c.info.method = method;
  c.info.profile = "paper";
  c.info.n = 4;
  c.info.seed = seed;
  for (const auto& s : stages) c.info.stages.push_back(s.stage);
  c.stages = std::move(stages);
  return c;
}

/// A claim of an experiment, of those that its folder adds.
inline ClaimResult judged(void (&add_claims)(Registry&),
                          const std::string& experiment,
                          const std::vector<CaseRecord>& cases,
                          const std::string& id) {
  Registry registered;
  registered.add(Experiment{.name = experiment});
  add_claims(registered);
  const Results results(cases);
  const Published published;
  for (const Claim& claim : registered.find(experiment)->claims)
    if (claim.id == id)
      return judge({claim},
                   {results, published, experiment},
                   {"smoke", "quick", "standard", "paper"})
          .front();
  return {};
}

}  // namespace physinv
