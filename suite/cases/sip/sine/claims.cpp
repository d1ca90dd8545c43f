#include "suite/cases/common/claims.h"

#include "suite/cases/sip/sine/problems.h"
#include "suite/cases/sip/sine/score.h"

namespace physinv::sine {

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("solution_range", solution_range());
  names.set("highest_slope", highest_slope(options_of(kHard)));
  names.set("newton_ascents", newton_ascents(options_of(kHard)));
  names.set("residual", residual(options_of(kHard)));
  names.add("share_beyond", share_beyond);
  names.add("of_8000_updates", at_quick);
  add_claims_of_folder(r, "sip/sine", names);
}

}  // namespace physinv::sine
