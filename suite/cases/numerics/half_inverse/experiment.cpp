// Half-inverse updates where their matrices are worst: physics of vanishing
// size, batches with every sample twice, saturated and empty networks.
#include <memory>
#include <utility>
#include <vector>

#include "problems/scaled_output/scaled_output.h"
#include "suite/cases/numerics/half_inverse/sweep.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"

namespace physinv::half_inverse_numerics {
namespace {

std::shared_ptr<const Stage> stress() {
  HalfInverseStressOptions options{.name = kStage,
                                   .problems = {},
                                   .taus = kTaus,
                                   .kappas = kKappas,
                                   .starts = kStarts,
                                   .samples = kSamples};
  for (const double gamma : kGammas)
    options.problems.push_back(problems::scaled_output({.gamma = gamma}));
  return half_inverse_stress(std::move(options));
}

const std::vector<Row> kRows = {{.methods = {kMethod}, .n = {1}, .seeds = {0}}};

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = kName,
      .title = "Numerics of half-inverse updates",
      .citation = {.paper = "hig", .where = "Secs. 2.1, 2.3"},
      .problem = problems::scaled_output(),
      .setting = {.predictor = {{Field::given},
                                nn::mlp({.hidden = {7},
                                         .activation = nn::Activation::tanh,
                                         .init = nn::Init::glorot})}},
      .profiles = {{.name = "smoke", .rows = kRows},
                   {.name = "quick", .rows = kRows},
                   {.name = "standard", .rows = kRows},
                   {.name = "paper", .rows = kRows}},
      .methods = {{kMethod, {stress()}}},
  });
}

}  // namespace physinv::half_inverse_numerics
