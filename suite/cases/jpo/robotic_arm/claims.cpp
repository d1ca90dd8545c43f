// What claims.md uses and formulas cannot express.
#include <algorithm>
#include <cmath>
#include <utility>

#include "suite/cases/jpo/common/claim_names.h"

namespace physinv::jpo::robotic_arm {
namespace {

constexpr double kSolved = 1e-12;

/// Of the targets that are missed: how far the tip would have to come in from
/// full stretch. 0 if there are none.
double slack_of_misses(const Run& run) {
  double slack = 0;
  for (Index i = 0; i < run.stage->loss.size(); ++i)
    if (!(run.stage->loss(i) < kSolved))
      slack = std::max(slack, 2 - std::abs(run.record->data.y(0, i)));
  return slack;
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = jpo::claim_names();
  names.set("slack_of_misses", slack_of_misses);
  add_claims_of_folder(r, "jpo/robotic_arm", names);
}

}  // namespace physinv::jpo::robotic_arm
