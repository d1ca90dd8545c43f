// JPO paper, Tables 4 and 5, Apps. D.1 and D.2: the wall that keeps the neural
// adjoint in the range of its training samples is not printed, nor how many
// these are and, for billiards, how far they are spread.
#include <string_view>
#include <vector>

#include "baselines/neural_adjoint.h"
#include "baselines/surrogate.h"
#include "optimizers/classical.h"
#include "suite/cases/jpo/adjoint_wall/settings.h"
#include "suite/cases/jpo/billiards/setting.h"
#include "suite/cases/jpo/wave_packet/setting.h"
#include "suite/harness/registry.h"
#include "suite/harness/study.h"

namespace physinv::adjoint_wall {
namespace {

constexpr Index kFit = 3000;

std::vector<Method> methods() {
  std::vector<Method> all = {{.id = "bfgs", .chain = {bfgs_solve()}}};
  for (const Wall& w : kWalls)
    all.push_back(
        {.id = w.method(),
         .chain = {surrogate_fit({.iterations = kFit}),
                   neural_adjoint_solve({.gamma = w.gamma, .weight = w.weight}),
                   bfgs_refine()}});
  return all;
}

std::vector<Profile> profiles(std::vector<Index> n,
                              std::vector<std::uint64_t> seeds) {
  Row classical{.methods = {"bfgs"}, .n = std::move(n), .seeds = seeds};
  Row trained = classical;
  trained.methods.clear(), trained.iterations = kFit;
  for (const Wall& w : kWalls) trained.methods.push_back(w.method());
  return {{.name = "study", .rows = {classical, trained}}};
}

Experiment experiment(const Study& s) {
  Experiment e{.name = s.name,
               .title = s.title,
               .citation = {.paper = "jpo", .where = "Tables 4 and 5"}};
  if (std::string_view(s.varied) == "jpo/billiards") {
    e.problem = problems::billiards({.velocity_spread = s.velocity_spread});
    e.setting = jpo::billiards::setting();
    e.profiles = profiles({2, 8, 32, 128}, first_seeds(3));
  } else {
    e.problem = jpo::wave_packet::recipe();
    e.setting = jpo::wave_packet::setting();
    e.profiles = profiles({8, 256}, first_seeds(3));
  }
  e.setting.labels.per_problem = s.labels;
  e.methods = methods();
  return e;
}

}  // namespace

void add_experiments(Registry& r) {
  for (const Study& s : kStudies) {
    register_study(s.name, s.varied);
    r.add(experiment(s));
  }
}

}  // namespace physinv::adjoint_wall
