// JPO paper, Sec. 4 "Kuramoto-Sivashinsky equation", Fig. 5, App. D.3: a
// chaotic solver whose gradients mislead one problem at a time, but not a
// network that sees many.
#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/cases/jpo/kuramoto_sivashinsky/setting.h"

namespace physinv::jpo::kuramoto_sivashinsky {
namespace {

constexpr Index kFitIterations = 1000;

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = "jpo/kuramoto-sivashinsky",
      .title = "Kuramoto-Sivashinsky equation",
      .citation = {.paper = "jpo", .where = "Sec. 4, Fig. 5, App. D.3"},
      .problem = recipe(),
      .setting = setting(),
      .profiles = {{.name = "smoke",
                    .rows = {row({"bfgs"}, 4, 1),
                             row({"gd"}, 4, 1, 5),
                             row(trained_methods(), 4, 1, 20)}},
                   {.name = "quick", .rows = jpo_rows({4, 32}, 3, 500)},
                   {.name = "paper",
                    .rows = jpo_rows(
                        {2, 4, 8, 16, 32, 64, 128, 256}, 10, kFitIterations)}},
      .methods = jpo_methods({.rate = 1e-3,
                              .iterations = kFitIterations,
                              .bfgs_iterations = 200,
                              .descent_iterations = 100}),
      .styles = kJpoStyles,
  });
}

}  // namespace physinv::jpo::kuramoto_sivashinsky
