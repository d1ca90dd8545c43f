// JPO paper, App. D.5, Fig. 25: an underdetermined problem with a loss like a
// bowl, where joint optimization needs no advantage over BFGS and shows none.
#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/cases/jpo/robotic_arm/setting.h"

namespace physinv::jpo::robotic_arm {
namespace {

constexpr Index kFitIterations = 2000;

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
            .rows = {row({"bfgs"}, 4, 1),
                     row({"gd"}, 4, 1, 50),
                     row(trained_methods(), 4, 1, 50)}},
           {.name = "quick", .rows = jpo_rows({8, 64}, 2, kFitIterations)},
           {.name = "paper",
            .rows = jpo_rows({2, 4, 8, 16, 32, 64, 128}, 4, kFitIterations)}},
      .methods = jpo_methods({.rate = 1e-3, .iterations = kFitIterations}),
      .styles = kJpoStyles,
  });
}

}  // namespace physinv::jpo::robotic_arm
