// JPO paper, Sec. 4 "Kuramoto-Sivashinsky equation", Fig. 5, App. D.3: a
// chaotic solver whose gradients mislead one problem at a time, but not a
// network that sees many.
#include <string>
#include <vector>

#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/cases/jpo/kuramoto_sivashinsky/claims.h"
#include "suite/cases/jpo/kuramoto_sivashinsky/figures.h"
#include "suite/harness/registry.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"

namespace physinv::ks {
namespace {

constexpr Index kFitIterations = 1000;

const auto kTrained = trained_methods();
const KuramotoSivashinskyOptions kPhysics;
const nn::VggOptions kPredictor{.channels = 2,
                                .grid = {.columns = 128},
                                .features = {32, 32, 64, 64},
                                .hidden = {64, 64}};

/// Names of the predictor's tensors, in the order of the records.
std::vector<std::string> tensors() {
  std::vector<std::string> names;
  const auto net =
      nn::vgg(kPredictor)
          .make<float>(kPredictor.channels * kPredictor.grid.positions(), 2);
  for (const TensorInfo& t : net->tensors()) names.push_back(t.name);
  return names;
}

/// Fig. 5c: curves of one n, gradient descent among them.
Figure curves_with_descent(JpoReportOptions options,
                           const Results& results,
                           const Published& published) {
  const JpoMetrics metrics(results, options.experiment);
  const auto sizes = metrics.sizes();
  options.methods.insert(options.methods.begin(), "gd");
  options.curves = {"fig5c", "Fig. 5c"};
  if (!sizes.empty()) options.curve_sizes = {sizes.back()};
  Figure figure = JpoReport(options, results, published).curves();
  figure.columns = 1;
  return figure;
}

Section report(const Results& results, const Published& published) {
  const JpoReportOptions options{.experiment = kName,
                                 .title = "Kuramoto-Sivashinsky equation",
                                 .paper = "jpo",
                                 .solved = solved(),
                                 .trajectory_size = 128,
                                 .unknowns = {"alpha", "beta"},
                                 .tensors = tensors(),
                                 .fraction = {"fig5d", "Fig. 5d"},
                                 .improvement = {"fig15", "Fig. 15"},
                                 .curves = {"fig16", "Fig. 16"},
                                 .trajectories = {"fig17", "Fig. 17"},
                                 .weight_change = {"fig18", "Fig. 18"}};
  Section section = jpo_section(options, results, published);
  section.figures.insert(section.figures.begin(),
                         {trajectory(kPhysics),
                          landscape(kPhysics),
                          curves_with_descent(options, results, published)});
  section.tables.push_back(in_words(JpoMetrics(results, kName), published));
  section.claims = claims(results);
  return section;
}

const std::vector<Index> kSizes = {2, 4, 8, 16, 32, 64, 128, 256};

const auto kRegistered = register_experiment({
    .name = kName,
    .title = "Kuramoto-Sivashinsky equation",
    .source = {.paper = "jpo", .where = "Sec. 4, Fig. 5, App. D.3"},
    .problem = problem<KuramotoSivashinsky>("kuramoto_sivashinsky", kPhysics),
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
    .profiles =
        {{.name = "smoke",
          .rows = {{.methods = {"bfgs"}, .n = {4}, .seeds = {0}},
                   {.methods = {"gd"}, .n = {4}, .seeds = {0}, .iterations = 5},
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
    .report = report,
});

}  // namespace
}  // namespace physinv::ks
