#include "suite/harness/judge.h"

#include "suite/harness/registry.h"

namespace physinv {

std::vector<std::string> profile_names(const Experiment& experiment) {
  std::vector<std::string> names;
  for (const Profile& p : experiment.profiles) names.push_back(p.name);
  return names;
}

std::vector<Claim> claims_of(const Registry& registry,
                             const std::string& name) {
  if (const auto e = registry.find(name)) return e->claims;
  for (const Overview& o : registry.overviews())
    if (o.paper == name) return o.claims;
  return {};
}

std::vector<ClaimResult> judge(const Experiment& experiment,
                               const Results& results,
                               const Published& published) {
  return judge(experiment.claims,
               {results, published, experiment.name},
               profile_names(experiment));
}

}  // namespace physinv
