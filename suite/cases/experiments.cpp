// Of all papers, in the order of the cases. What runs cases alone links this.
#include "suite/cases/tables.h"

namespace physinv {

void add_experiments(Registry& r) {
  name_quantities();
  jpo::add_experiments(r);
  hig::add_experiments(r);
  physgrad::add_experiments(r);
  sip::add_experiments(r);
  matrix::add_experiments(r);
  numerics::add_experiments(r);
}

}  // namespace physinv
