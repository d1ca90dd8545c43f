#include "suite/cases/common/claims.h"

#include "suite/cases/sip/wave_packet/values.h"

namespace physinv::sip_wave_packet {

void add_claims(Registry& r) {
  ClaimNames names = claim_names();
  names.add("period", kPeriod);
  names.add("half_period", kBasin);
  names.add("error_row", metric(kMeanError));
  names.add("errors", [] { return errors(); });
  names.add("errors", errors);
  names.add("moves", moves);
  names.add("off_period", off_period());
  names.add("off_missed_period", off_missed_period);
  names.add("loss_over_lbfgs", loss_over_lbfgs());
  names.add("in_basin", in_basin());
  names.add("passes_lbfgs", passes_lbfgs());
  names.add("passes_lbfgs_error", passes_lbfgs_error());
  add_claims_of_folder(r, "sip/wave_packet", names);
}

}  // namespace physinv::sip_wave_packet
