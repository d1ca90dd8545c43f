// What the chapter says, and its pages.
#include "suite/cases/tables.h"

namespace physinv {

namespace scaling {
Add add_claims, add_reports;
}

namespace physgrad {

void add_claims(Registry& r) {
  scaling::add_claims(r);
  scaling::add_reports(r);
}

}  // namespace physgrad
}  // namespace physinv
