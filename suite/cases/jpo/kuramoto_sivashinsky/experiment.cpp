// JPO paper, Sec. 4 "Kuramoto-Sivashinsky equation", Fig. 5, App. D.3: a
// chaotic solver whose gradients mislead one problem at a time, but not a
// network that sees many.
#include <vector>

#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/cases/jpo/kuramoto_sivashinsky/setting.h"

namespace physinv::jpo::kuramoto_sivashinsky {
namespace {

constexpr Index kFitIterations = 1000;

const auto kTrained = trained_methods();
const std::vector<Index> kSizes = {2, 4, 8, 16, 32, 64, 128, 256};

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = "jpo/kuramoto-sivashinsky",
      .title = "Kuramoto-Sivashinsky equation",
      .citation = {.paper = "jpo", .where = "Sec. 4, Fig. 5, App. D.3"},
      .problem = recipe(),
      .setting = setting(),
      .profiles = {{.name = "smoke",
                    .rows = {{.methods = {"bfgs"}, .n = {4}, .seeds = {0}},
                             {.methods = {"gd"},
                              .n = {4},
                              .seeds = {0},
                              .iterations = 5},
                             {.methods = kTrained,
                              .n = {4},
                              .seeds = {0},
                              .iterations = 20}}},
                   {.name = "quick",
                    .rows = {{.methods = {"bfgs", "gd"},
                              .n = {4, 32},
                              .seeds = first_seeds(3)},
                             {.methods = kTrained,
                              .n = {4, 32},
                              .seeds = first_seeds(3),
                              .iterations = 500}}},
                   {.name = "paper",
                    .rows = {{.methods = {"bfgs", "gd"},
                              .n = kSizes,
                              .seeds = first_seeds(10)},
                             {.methods = kTrained,
                              .n = kSizes,
                              .seeds = first_seeds(10),
                              .iterations = kFitIterations}}}},
      .methods = jpo_methods({.rate = 1e-3,
                              .iterations = kFitIterations,
                              .bfgs_iterations = 200,
                              .descent_iterations = 100}),
      .styles = kJpoStyles,
  });
}

}  // namespace physinv::jpo::kuramoto_sivashinsky
