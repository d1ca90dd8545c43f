// JPO paper, App. D.5, Fig. 25: an underdetermined problem with a loss like a
// bowl, where joint optimization needs no advantage over BFGS and shows none.
#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/cases/jpo/robotic_arm/setting.h"

namespace physinv::jpo::robotic_arm {
namespace {

constexpr Index kFitIterations = 2000;

const auto kTrained = trained_methods();

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = "jpo/robotic-arm",
      .title = "Robotic arm",
      .citation = {.paper = "jpo", .where = "App. D.5, Fig. 25"},
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
                  .iterations = 50}}},
           {.name = "quick",
            .rows = {{.methods = {"bfgs", "gd"}, .n = {8, 64}, .seeds = {0, 1}},
                     {.methods = kTrained,
                      .n = {8, 64},
                      .seeds = {0, 1},
                      .iterations = kFitIterations}}},
           {.name = "paper",
            .rows = {{.methods = {"bfgs", "gd"},
                      .n = {2, 4, 8, 16, 32, 64, 128},
                      .seeds = {0, 1, 2, 3}},
                     {.methods = kTrained,
                      .n = {2, 4, 8, 16, 32, 64, 128},
                      .seeds = {0, 1, 2, 3},
                      .iterations = kFitIterations}}}},
      .methods = jpo_methods({.rate = 1e-3, .iterations = kFitIterations}),
      .styles = kJpoStyles,
  });
}

}  // namespace physinv::jpo::robotic_arm
