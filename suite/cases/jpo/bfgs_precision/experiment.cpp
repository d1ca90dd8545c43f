// JPO paper, Tables 4 and 5, Sec. 4: precision and tolerance of BFGS and of the
// refinement are not printed. Everything else is that of the experiment which
// is varied, at some of its sizes.
#include <string_view>
#include <vector>

#include "optimizers/classical.h"
#include "optimizers/jpo.h"
#include "suite/cases/jpo/bfgs_precision/settings.h"
#include "suite/cases/jpo/billiards/setting.h"
#include "suite/cases/jpo/kuramoto_sivashinsky/setting.h"
#include "suite/cases/jpo/navier_stokes/setting.h"
#include "suite/cases/jpo/robotic_arm/setting.h"
#include "suite/cases/jpo/wave_packet/setting.h"
#include "suite/harness/registry.h"
#include "suite/harness/study.h"

namespace physinv::bfgs_precision {
namespace {

/// How an experiment fits and solves, and what of it the study runs.
struct Varied {
  const char* name;
  ProblemRecipe problem;
  Setting setting;
  double rate;  ///< of JPO's Adam
  Index iterations;
  BfgsStageOptions bfgs;
  std::vector<Index> n;
  std::uint64_t seeds;
};

std::vector<Varied> all_varied() {
  return {{"jpo/billiards",
           jpo::billiards::recipe(),
           jpo::billiards::setting(),
           1e-4,
           3000,
           {},
           {2, 8, 32, 128},
           3},
          {"jpo/wave-packet",
           jpo::wave_packet::recipe(),
           jpo::wave_packet::setting(),
           1e-3,
           3000,
           {},
           {2, 8, 32},
           3},
          {"jpo/kuramoto-sivashinsky",
           jpo::kuramoto_sivashinsky::recipe(),
           jpo::kuramoto_sivashinsky::setting(),
           1e-3,
           1000,
           {.iterations = 200},
           {2, 8, 32},
           3},
          {"jpo/robotic-arm",
           jpo::robotic_arm::recipe(),
           jpo::robotic_arm::setting(),
           1e-3,
           2000,
           {},
           {8, 64},
           3},
          {"jpo/navier-stokes",
           jpo::navier_stokes::recipe(),
           jpo::navier_stokes::setting(),
           1e-3,
           1000,
           jpo::navier_stokes::kBfgs,
           {4, 16},
           3}};
}

Experiment experiment(const Study& study, const Varied& varied) {
  Experiment e{.name = study.name,
               .title = study.title,
               .citation = {.paper = "jpo", .where = "Sec. 4, Tables 4 and 5"},
               .problem = varied.problem,
               .setting = varied.setting};
  Row classical{.n = varied.n, .seeds = first_seeds(varied.seeds)};
  Row trained = classical;
  trained.iterations = varied.iterations;
  for (const Choice& c : study.choices) {
    BfgsStageOptions bfgs = varied.bfgs;
    bfgs.gtol = c.gtol, bfgs.single = c.single;
    e.methods.push_back({.id = c.bfgs(), .chain = {bfgs_solve(bfgs)}});
    e.methods.push_back(
        {.id = c.jpo(),
         .chain = {jpo_fit({.step = AdamOptions{.rate = varied.rate},
                            .iterations = varied.iterations}),
                   bfgs_refine(bfgs)}});
    classical.methods.push_back(c.bfgs());
    trained.methods.push_back(c.jpo());
  }
  e.profiles = {{.name = "study", .rows = {classical, trained}}};
  return e;
}

}  // namespace

void add_experiments(Registry& r) {
  const auto known = all_varied();
  for (const Study& study : all_studies())
    for (const Varied& varied : known)
      if (std::string_view(study.varied) == varied.name) {
        register_study(study.name, study.varied);
        r.add(experiment(study, varied));
      }
}

}  // namespace physinv::bfgs_precision
