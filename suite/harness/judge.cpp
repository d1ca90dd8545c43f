#include "suite/harness/judge.h"

namespace physinv {

std::vector<std::string> profile_names(const Experiment& experiment) {
  std::vector<std::string> names;
  for (const Profile& p : experiment.profiles) names.push_back(p.name);
  return names;
}

std::vector<ClaimResult> judge(const Experiment& experiment,
                               const Results& results,
                               const Published& published) {
  return judge(experiment.claims,
               {results, published, experiment.name},
               profile_names(experiment));
}

}  // namespace physinv
