// JPO paper, Tables 4 and 5: precision and tolerance of BFGS and of the
// refinement are not printed. Everything else is the paper's billiards.
#include "optimizers/classical.h"
#include "optimizers/jpo.h"
#include "suite/cases/jpo/billiards/setting.h"
#include "suite/cases/jpo/billiards_precision/settings.h"
#include "suite/harness/registry.h"
#include "suite/harness/study.h"

namespace physinv::billiards_precision {
namespace {

/// The paper's sizes but those between, and three of its seeds.
std::vector<Profile> profiles() {
  Row classical{.n = {2, 8, 32, 128}, .seeds = first_seeds(3)};
  Row trained = classical;
  trained.iterations = 3000;
  for (const Setting& s : kSettings) {
    classical.methods.push_back(s.bfgs());
    trained.methods.push_back(s.jpo());
  }
  return {{.name = "study", .rows = {classical, trained}}};
}

std::vector<Method> methods() {
  std::vector<Method> all;
  for (const Setting& s : kSettings) {
    const BfgsStageOptions bfgs{.gtol = s.gtol, .single = s.single};
    all.push_back({.id = s.bfgs(), .chain = {bfgs_solve(bfgs)}});
    all.push_back({.id = s.jpo(),
                   .chain = {jpo_fit({.step = AdamOptions{.rate = 1e-4},
                                      .iterations = 3000}),
                             bfgs_refine(bfgs)}});
  }
  return all;
}

}  // namespace

void add_experiments(Registry& r) {
  register_study(kName, kVaried);
  r.add(Experiment{.name = kName,
                   .title = "Billiards, precision and tolerance of BFGS",
                   .source = {.paper = "jpo", .where = "Tables 4 and 5"},
                   .problem = jpo::billiards::recipe(),
                   .setting = jpo::billiards::setting(),
                   .profiles = profiles(),
                   .methods = methods()});
}

}  // namespace physinv::billiards_precision
