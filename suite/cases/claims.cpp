// All that the suite has: experiments, then what is said of them.
#include "suite/cases/tables.h"

namespace physinv {

void register_all(Registry& r) {
  add_experiments(r);
  jpo::add_claims(r);
  hig::add_claims(r);
  physgrad::add_claims(r);
  sip::add_claims(r);
  matrix::add_reports(r);
  numerics::add_claims(r);
}

}  // namespace physinv
