// The programs over one folder of experiments, which only run.
#include "suite/app/conclude.h"
#include "suite/app/verbs.h"

namespace physinv {

const Program& program() {
  static const Program bench{
      .name = "physinv-bench",
      .verbs = {{"run", "[FILTER]", "run cases (the default verb)", run_verb}},
      .examples = {},
      .environment = {},
      .conclude = conclude};
  return bench;
}

}  // namespace physinv
