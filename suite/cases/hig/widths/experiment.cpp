// HIG paper, Secs. 1 and 2.3: what an update costs by the number of parameters.
// The oscillators of Sec. 3.1 with three hidden layers of several widths.
#include <fmt/format.h>

#include "optimizers/training.h"
#include "problems/oscillators/oscillators.h"
#include "suite/cases/hig/common/methods.h"
#include "suite/cases/hig/widths/widths.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"

namespace physinv::hig::widths {
namespace {

constexpr RowOf row{.n = 64};
constexpr Index kBatch = 64, kUpdates = 24;

Experiment experiment(Index width) {
  const HalfInverseStepOptions step{.power = {.kappa = -0.5, .tau = 1e-6}};
  return {.name = name_of(width),
          .title = fmt::format("Nonlinear oscillators, {} wide", width),
          .citation = {.paper = "hig", .where = "Sec. 2.3"},
          .problem = problems::oscillators(),
          .setting = {.predictor = {{Field::observations},
                                    nn::mlp({.hidden = {width, width, width},
                                             .init = nn::Init::glorot})},
                      .recorded = 16},
          .profiles = {{.name = "paper",
                        .rows = {row({"hig"}, first_seeds(3), kUpdates)}}},
          .methods = {{.id = "hig",
                       .chain = {train({.rule = step, .batch = kBatch})}}}};
}

}  // namespace

void add_experiments(Registry& r) {
  for (const Index width : kWidths) r.add(experiment(width));
}

}  // namespace physinv::hig::widths
