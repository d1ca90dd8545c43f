#include "suite/cases/common/claims.h"

#include "suite/cases/sip/wave_packet/values.h"

namespace physinv::sip_wave_packet {

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.set("period", kPeriod);
  names.set("half_period", kBasin);
  names.set("error_row", metric(kMeanError));
  names.add("errors", [] { return errors(); });
  names.add("errors", errors);
  names.add("moves", moves);
  names.set("off_period", off_period());
  names.add("off_missed_period", off_missed_period);
  names.set("loss_over_lbfgs", loss_over_lbfgs());
  names.set("in_basin", in_basin());
  names.set("passes_lbfgs", passes_lbfgs());
  names.set("passes_lbfgs_error", passes_lbfgs_error());
  add_claims_of_folder(r, "sip/wave_packet", names);
}

}  // namespace physinv::sip_wave_packet
