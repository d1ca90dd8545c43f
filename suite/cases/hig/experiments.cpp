// Experiments of the HIG paper.
#include "suite/cases/tables.h"

namespace physinv {

namespace oscillators {
Add add_experiments;
}
namespace hig::poisson {
Add add_experiments;
}
namespace dipole {
Add add_direct_experiment, add_experiments;
}
namespace toy {
Add add_experiments;
}
namespace hig::widths {
Add add_experiments;
}
namespace hig::ablation_batch {
Add add_experiments;
}

namespace hig {

void add_experiments(Registry& r) {
  oscillators::add_experiments(r);
  poisson::add_experiments(r);
  dipole::add_direct_experiment(r);
  dipole::add_experiments(r);
  toy::add_experiments(r);
  widths::add_experiments(r);
  ablation_batch::add_experiments(r);
}

}  // namespace hig
}  // namespace physinv
