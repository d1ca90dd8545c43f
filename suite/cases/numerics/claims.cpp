// What is said of solvers and is not part of an atlas.
#include "suite/cases/tables.h"

namespace physinv {

namespace half_inverse_numerics {
Add add_claims, add_reports;
}
namespace ks_numerics {
Add add_claims, add_reports;
}
namespace numerics::overview {
Add add_reports;
}

namespace numerics {

void add_claims(Registry& r) {
  half_inverse_numerics::add_claims(r);
  half_inverse_numerics::add_reports(r);
  ks_numerics::add_claims(r);
  ks_numerics::add_reports(r);
  overview::add_reports(r);
}

}  // namespace numerics
}  // namespace physinv
