// JPO paper, Sec. 4 "Incompressible Navier-Stokes", Sec. 6: "bounded
// parameters" pass through tanh, which of the three are bounded is not printed.
// An experiment for each reading.
#include "optimizers/classical.h"
#include "optimizers/jpo.h"
#include "suite/cases/jpo/flow_bounds/settings.h"
#include "suite/cases/jpo/navier_stokes/setting.h"
#include "suite/harness/registry.h"
#include "suite/harness/study.h"

namespace physinv::flow_bounds {
namespace {

constexpr Index kFit = 1000;
using jpo::navier_stokes::kBfgs;

Experiment experiment(const Choice& c) {
  const Row classical{
      .methods = {"bfgs"}, .n = {4, 16, 32}, .seeds = first_seeds(3)};
  const Row trained{.methods = {"jpo"},
                    .n = {16},
                    .seeds = first_seeds(3),
                    .iterations = kFit};
  Setting setting = jpo::navier_stokes::setting();
  setting.labels.bounded = c.bounded;
  return {.name = c.name(),
          .title = fmt::format("Navier-Stokes, bounded: {}", c.title),
          .citation = {.paper = "jpo", .where = "Sec. 4, Tables 4 and 5"},
          .problem = jpo::navier_stokes::recipe(c.bounded),
          .setting = std::move(setting),
          .profiles = {{.name = "study", .rows = {classical, trained}}},
          .methods = {{.id = "bfgs", .chain = {bfgs_solve(kBfgs)}},
                      {.id = "jpo",
                       .chain = {jpo_fit({.step = AdamOptions{.rate = 1e-3},
                                          .iterations = kFit}),
                                 bfgs_refine(kBfgs)}}}};
}

}  // namespace

void add_experiments(Registry& r) {
  for (const Choice& c : kChoices) {
    register_study(c.name(), "jpo/navier-stokes");
    r.add(experiment(c));
  }
}

}  // namespace physinv::flow_bounds
