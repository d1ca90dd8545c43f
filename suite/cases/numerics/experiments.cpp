// What solvers can do, problem by problem.
#include "suite/cases/tables.h"

namespace physinv {

namespace numerics::billiards {
Add add_experiments;
}
namespace numerics::exponential {
Add add_experiments;
}
namespace numerics::grid_poisson {
Add add_experiments;
}
namespace half_inverse_numerics {
Add add_experiments;
}
namespace numerics::heat {
Add add_experiments;
}
namespace ks_numerics {
Add add_experiments;
}
namespace numerics::marker_flow {
Add add_experiments;
}
namespace numerics::navier_stokes {
Add add_experiments;
}
namespace numerics::noisy_absolute {
Add add_experiments;
}
namespace numerics::oscillators {
Add add_experiments;
}
namespace numerics::poisson_plane {
Add add_experiments;
}
namespace numerics::quantum_dipole {
Add add_experiments;
}
namespace numerics::robotic_arm {
Add add_experiments;
}
namespace numerics::scaled_output {
Add add_experiments;
}
namespace numerics::sine_plane {
Add add_experiments;
}
namespace numerics::transport {
Add add_experiments;
}
namespace numerics::wave_packet {
Add add_experiments;
}

namespace numerics {

void add_experiments(Registry& r) {
  billiards::add_experiments(r);
  exponential::add_experiments(r);
  grid_poisson::add_experiments(r);
  half_inverse_numerics::add_experiments(r);
  heat::add_experiments(r);
  ks_numerics::add_experiments(r);
  marker_flow::add_experiments(r);
  navier_stokes::add_experiments(r);
  noisy_absolute::add_experiments(r);
  oscillators::add_experiments(r);
  poisson_plane::add_experiments(r);
  quantum_dipole::add_experiments(r);
  robotic_arm::add_experiments(r);
  scaled_output::add_experiments(r);
  sine_plane::add_experiments(r);
  transport::add_experiments(r);
  wave_packet::add_experiments(r);
}

}  // namespace numerics
}  // namespace physinv
