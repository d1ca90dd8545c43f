// JPO paper, Sec. 4 "Incompressible Navier-Stokes", Fig. 6, App. D.4: where was
// the blast that is seen above the obstacles, and how strong?
#include <string>
#include <utility>
#include <vector>

#include "optimizers/half_inverse_direct.h"
#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/cases/jpo/navier_stokes/setting.h"

namespace physinv::jpo::navier_stokes {
namespace {

constexpr Index kFitIterations = 1000;

/// Powers of the problem's own Jacobian, three tangent runs an update: what
/// the paper does not have.
Method by_jacobian(std::string id, double kappa) {
  return {
      .id = std::move(id),
      .chain = {half_inverse_direct(
          {.stage = "solve", .power = {.kappa = kappa}, .iterations = 30})}};
}

std::vector<Method> methods() {
  return {
      {"bfgs", {bfgs_solve(kBfgs)}},
      {"gd", {bold_descent_solve()}},
      by_jacobian("gn", 1),
      by_jacobian("hig", 0.5),
      {"jpo",
       {jpo_fit(
            {.step = AdamOptions{.rate = 1e-3}, .iterations = kFitIterations}),
        bfgs_refine(kBfgs)}},
      {"supervised",
       {supervised_fit({.iterations = kFitIterations}), bfgs_refine(kBfgs)}},
      {"na",
       {surrogate_fit({.iterations = kFitIterations}),
        neural_adjoint_solve({.iterations = 100, .fixed_weight = 100}),
        bfgs_refine(kBfgs)}}};
}

const std::vector<std::string> kSingly = {"bfgs", "gd", "gn", "hig"};
const std::vector<Index> kSizes = {4, 8, 16, 32, 64, 128};

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = "jpo/navier-stokes",
      .title = "Incompressible Navier-Stokes",
      .citation = {.paper = "jpo", .where = "Sec. 4, Fig. 6, App. D.4"},
      .problem = recipe(),
      .setting = setting(),
      .profiles =
          {{.name = "smoke",
            .rows =
                {{.methods = kSingly, .n = {4}, .seeds = {0}, .iterations = 5},
                 {.methods = trained_methods(),
                  .n = {2},
                  .seeds = {0},
                  .iterations = 5}}},
           {.name = "quick",
            .rows = {{.methods = kSingly, .n = {16}, .seeds = {0}},
                     {.methods = trained_methods(),
                      .n = {16},
                      .seeds = {0},
                      .iterations = kFitIterations}}},
           {.name = "paper",
            .rows = {{.methods = kSingly, .n = kSizes, .seeds = first_seeds(4)},
                     {.methods = trained_methods(),
                      .n = kSizes,
                      .seeds = first_seeds(4),
                      .iterations = kFitIterations}}}},
      .methods = methods(),
      .styles = kJpoStyles,
  });
}

}  // namespace physinv::jpo::navier_stokes
