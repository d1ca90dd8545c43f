// What the SIP paper says, and its pages.
#include "suite/cases/tables.h"

namespace physinv {

namespace sip::overview {
Add add_claims;
}
namespace exponential {
Add add_claims, add_reports;
}
namespace fluid_case {
Add add_claims, add_reports;
}
namespace sine {
Add add_claims, add_reports;
}
namespace heat {
Add add_claims, add_reports;
}
namespace poisson {
Add add_claims, add_reports;
}
namespace sip_wave_packet {
Add add_claims, add_reports;
}
namespace packet_width {
Add add_claims;
}

namespace sip {

void add_claims(Registry& r) {
  overview::add_claims(r);
  exponential::add_claims(r);
  exponential::add_reports(r);
  fluid_case::add_claims(r);
  fluid_case::add_reports(r);
  sine::add_claims(r);
  sine::add_reports(r);
  heat::add_claims(r);
  heat::add_reports(r);
  poisson::add_claims(r);
  poisson::add_reports(r);
  sip_wave_packet::add_claims(r);
  sip_wave_packet::add_reports(r);
  packet_width::add_claims(r);
}

}  // namespace sip
}  // namespace physinv
