// What the HIG paper says, and its pages.
#include "suite/cases/tables.h"

namespace physinv {

namespace hig::overview {
Add add_claims;
}
namespace oscillators {
Add add_claims, add_reports;
}
namespace hig::poisson {
Add add_claims, add_reports;
}
namespace dipole {
Add add_claims, add_reports;
}
namespace toy {
Add add_claims, add_reports;
}
namespace hig::ablation_batch {
Add add_claims;
}

namespace hig {

void add_claims(Registry& r) {
  overview::add_claims(r);
  oscillators::add_claims(r);
  oscillators::add_reports(r);
  poisson::add_claims(r);
  poisson::add_reports(r);
  dipole::add_claims(r);
  dipole::add_reports(r);
  toy::add_claims(r);
  toy::add_reports(r);
  ablation_batch::add_claims(r);
}

}  // namespace hig
}  // namespace physinv
