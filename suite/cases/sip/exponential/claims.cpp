#include "suite/cases/common/claims.h"

#include "suite/cases/sip/exponential/metrics.h"
#include "suite/evidence/training.h"

namespace physinv::exponential {

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("mean_error", metric(kMean));
  names.set("low", metric(kLow));
  names.set("high", metric(kHigh));
  names.set("spread", metric(kSpread));
  names.set("rise", metric(kRise));
  add_claims_of_folder(r, "sip/exponential", names);
}

}  // namespace physinv::exponential
