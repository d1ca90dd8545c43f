// The programs over one folder of experiments, which only run.
#include "suite/app/conclude.h"
#include "suite/app/verbs.h"

namespace physinv {

const Program& program() {
  static const Program bench{.name = "physinv-bench",
                             .verbs = {kRunVerb},
                             .examples = {},
                             .environment = {},
                             .conclude = conclude};
  return bench;
}

}  // namespace physinv
