// JPO paper, Sec. 4 "Kuramoto-Sivashinsky equation", Fig. 5, App. D.3: a
// chaotic solver whose gradients mislead one problem at a time, but not a
// network that sees many.
#include <vector>

#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/harness/registry.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"

namespace physinv::jpo::kuramoto_sivashinsky {
namespace {

constexpr Index kFitIterations = 1000;

const auto kTrained = trained_methods();
const nn::VggOptions kPredictor{.channels = 2,
                                .grid = {.columns = 128},
                                .features = {32, 32, 64, 64},
                                .hidden = {64, 64}};

const std::vector<Index> kSizes = {2, 4, 8, 16, 32, 64, 128, 256};

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = "jpo/kuramoto-sivashinsky",
      .title = "Kuramoto-Sivashinsky equation",
      .source = {.paper = "jpo", .where = "Sec. 4, Fig. 5, App. D.3"},
      .problem = problem<KuramotoSivashinsky>("kuramoto_sivashinsky"),
      .setting = {.predictor = {{Field::given, Field::observations},
                                nn::vgg(kPredictor)},
                  .surrogate = {{Field::given, Field::unknowns},
                                nn::unet({.grid = {.columns = 128},
                                          .channels = 1,
                                          .scalars_after = 2,
                                          .scalar_shift = 1,
                                          .scalar_unit = 0.25})},
                  .output_scale = 0.25,
                  .gtol = 1e-10},
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
      .looks = kJpoLooks,
  });
}

}  // namespace physinv::jpo::kuramoto_sivashinsky
