// What physinv-run has.
#include "suite/app/verbs.h"

namespace physinv {

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
