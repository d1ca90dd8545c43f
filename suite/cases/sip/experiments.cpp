// Experiments of the SIP paper, and a study of what it leaves open.
#include "suite/cases/tables.h"

namespace physinv {

namespace exponential {
Add add_experiments;
}
namespace fluid_case {
Add add_experiments;
}
namespace sine {
Add add_experiments;
}
namespace heat {
Add add_experiments;
}
namespace poisson {
Add add_experiments;
}
namespace sip_wave_packet {
Add add_experiments;
}
namespace packet_width {
Add add_experiments;
}

namespace sip {

void add_experiments(Registry& r) {
  exponential::add_experiments(r);
  fluid_case::add_experiments(r);
  sine::add_experiments(r);
  heat::add_experiments(r);
  poisson::add_experiments(r);
  sip_wave_packet::add_experiments(r);
  packet_width::add_experiments(r);
}

}  // namespace sip
}  // namespace physinv
