// What the JPO paper says, and its pages.
#include "suite/cases/tables.h"

namespace physinv {

namespace jpo::overview {
Add add_claims;
}
namespace jpo::billiards {
Add add_claims, add_reports;
}
namespace alignment {
Add add_claims, add_reports;
}
namespace jpo::kuramoto_sivashinsky {
Add add_claims, add_reports;
}
namespace jpo::navier_stokes {
Add add_claims, add_reports;
}
namespace jpo::robotic_arm {
Add add_claims, add_reports;
}
namespace jpo::wave_packet {
Add add_claims, add_reports;
}
namespace bfgs_precision {
Add add_claims;
}
namespace adjoint_wall {
Add add_claims;
}
namespace packet_unit {
Add add_claims;
}
namespace flow_bounds {
Add add_claims;
}

namespace jpo {

void add_claims(Registry& r) {
  overview::add_claims(r);
  billiards::add_claims(r);
  billiards::add_reports(r);
  alignment::add_claims(r);
  alignment::add_reports(r);
  kuramoto_sivashinsky::add_claims(r);
  kuramoto_sivashinsky::add_reports(r);
  navier_stokes::add_claims(r);
  navier_stokes::add_reports(r);
  robotic_arm::add_claims(r);
  robotic_arm::add_reports(r);
  wave_packet::add_claims(r);
  wave_packet::add_reports(r);
  bfgs_precision::add_claims(r);
  adjoint_wall::add_claims(r);
  packet_unit::add_claims(r);
  flow_bounds::add_claims(r);
}

}  // namespace jpo
}  // namespace physinv
