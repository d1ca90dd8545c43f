#include "suite/cases/common/claims.h"

#include "suite/cases/sip/exponential/metrics.h"
#include "suite/evidence/training.h"

namespace physinv::exponential {

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.add("mean_error", metric(kMean));
  names.add("low", metric(kLow));
  names.add("high", metric(kHigh));
  names.add("spread", metric(kSpread));
  names.add("rise", metric(kRise));
  add_claims_of_folder(r, "sip/exponential", names);
}

}  // namespace physinv::exponential
