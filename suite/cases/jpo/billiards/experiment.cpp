// JPO paper, Sec. 4 "Billiards", Fig. 4, App. D.2: joint optimization against
// BFGS where a fifth of all problems start on a plateau.
#include "suite/cases/jpo/billiards/setting.h"
#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"

namespace physinv::jpo::billiards {
namespace {

const auto kTrained = trained_methods();

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = "jpo/billiards",
      .title = "Billiards",
      .citation = {.paper = "jpo", .where = "Sec. 4, Fig. 4, App. D.2"},
      .problem = recipe(),
      .setting = setting(),
      .profiles =
          {{.name = "smoke",
            .rows =
                {{.methods = {"bfgs"}, .n = {4}, .seeds = {0}},
                 {.methods = {"gd"}, .n = {4}, .seeds = {0}, .iterations = 50},
                 {.methods = kTrained,
                  .n = {4},
                  .seeds = {0},
                  .iterations = 50},
                 {.methods = {"bfgs"}, .n = {128}, .seeds = {0, 1, 2, 3}}}},
           {.name = "quick",
            .rows = {{.methods = {"bfgs", "gd"},
                      .n = {8, 32, 128},
                      .seeds = {0, 1}},
                     {.methods = kTrained,
                      .n = {8, 32, 128},
                      .seeds = {0, 1},
                      .iterations = 3000}}},
           {.name = "paper",
            .rows = {{.methods = {"bfgs", "gd"},
                      .n = {2, 4, 8, 16, 32, 64, 128},
                      .seeds = {0, 1, 2, 3}},
                     {.methods = kTrained,
                      .n = {2, 4, 8, 16, 32, 64, 128},
                      .seeds = {0, 1, 2, 3},
                      .iterations = 3000}}}},
      .methods = jpo_methods(),
      .styles = kJpoStyles,
  });
}

}  // namespace physinv::jpo::billiards
