// What physinv-run has: no claims, no pages.
#include "suite/app/verbs.h"
#include "suite/cases/tables.h"

namespace physinv {

void register_all(Registry& r) { add_experiments(r); }

const Program& program() {
  static const Program run{
      .name = "physinv-run",
      .verbs = {{"run", "[FILTER]", "run cases (the default verb)", run_verb}},
      .examples = {"--filter=billiards",
                   "--profile=paper --filter=billiards --out=results/paper"},
      .environment = ""};
  return run;
}

}  // namespace physinv
