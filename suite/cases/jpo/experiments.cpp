// Experiments of the JPO paper, and studies of what it leaves open.
#include "suite/cases/tables.h"

namespace physinv {

namespace jpo::billiards {
Add add_experiments;
}
namespace alignment {
Add add_experiments;
}
namespace jpo::kuramoto_sivashinsky {
Add add_experiments;
}
namespace jpo::navier_stokes {
Add add_experiments;
}
namespace jpo::robotic_arm {
Add add_experiments;
}
namespace jpo::wave_packet {
Add add_experiments;
}
namespace bfgs_precision {
Add add_experiments;
}
namespace adjoint_wall {
Add add_experiments;
}
namespace packet_unit {
Add add_experiments;
}
namespace flow_bounds {
Add add_experiments;
}

namespace jpo {

void add_experiments(Registry& r) {
  billiards::add_experiments(r);
  alignment::add_experiments(r);
  kuramoto_sivashinsky::add_experiments(r);
  navier_stokes::add_experiments(r);
  robotic_arm::add_experiments(r);
  wave_packet::add_experiments(r);
  bfgs_precision::add_experiments(r);
  adjoint_wall::add_experiments(r);
  packet_unit::add_experiments(r);
  flow_bounds::add_experiments(r);
}

}  // namespace jpo
}  // namespace physinv
