// Experiments of the chapter.
#include "suite/cases/tables.h"

namespace physinv {

namespace scaling {
Add add_experiments;
}

namespace physgrad {

void add_experiments(Registry& r) { scaling::add_experiments(r); }

}  // namespace physgrad
}  // namespace physinv
