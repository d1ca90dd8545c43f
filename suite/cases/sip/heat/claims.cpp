#include "suite/cases/common/claims.h"

#include <optional>

#include "suite/cases/sip/heat/metrics.h"
#include "suite/evidence/training.h"

namespace physinv::heat {
namespace {

/// Of the examples' losses, for stages that leave no mean.
RunValue mean_loss_after(Index steps) {
  return [=](const Run& run) -> std::optional<double> {
    const auto k = last_point(*run.stage, steps);
    return k ? std::optional(run.stage->curve.loss.col(*k).mean())
             : std::nullopt;
  };
}

/// Seconds that an example takes, of methods that take them one by one.
RunValue seconds_per_example(double iterations) {
  return [=](const Run& run) -> std::optional<double> {
    const auto one = seconds_per_update()(run);
    if (!one) return {};
    return iterations * *one / static_cast<double>(run.n());
  };
}

}  // namespace

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("error", metric(kError));
  names.set("clamped_error", metric(kClamped));
  names.set("coarse_left", metric(kCoarse));
  names.set("fine_left", metric(kFine));
  names.set("error_of_mean", metric(kOfMean));
  names.set("error_of_observed", metric(kOfObserved));
  names.set("undamped", metric(kOfInverse));
  names.add("mean_loss_after", mean_loss_after);
  names.add("seconds_per_example", seconds_per_example);
  add_claims_of_folder(r, "sip/heat", names);
}

}  // namespace physinv::heat
