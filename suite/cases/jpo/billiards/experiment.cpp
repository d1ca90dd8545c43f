// JPO paper, Sec. 4 "Billiards", Fig. 4, App. D.2: joint optimization against
// BFGS where a fifth of all problems start on a plateau.
#include "suite/cases/jpo/billiards/setting.h"
#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"

namespace physinv::jpo::billiards {

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = "jpo/billiards",
      .title = "Billiards",
      .citation = {.paper = "jpo", .where = "Sec. 4, Fig. 4, App. D.2"},
      .problem = recipe(),
      .setting = setting(),
      .profiles = {{.name = "smoke",
                    .rows = {row({"bfgs"}, 4, 1),
                             row({"gd"}, 4, 1, 50),
                             row(trained_methods(), 4, 1, 50),
                             row({"bfgs"}, 128, 4)}},
                   {.name = "quick", .rows = jpo_rows({8, 32, 128}, 2, 3000)},
                   {.name = "paper",
                    .rows = jpo_rows({2, 4, 8, 16, 32, 64, 128}, 4, 3000)}},
      .methods = jpo_methods(),
      .styles = kJpoStyles,
  });
}

}  // namespace physinv::jpo::billiards
