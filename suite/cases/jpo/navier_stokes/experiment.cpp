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

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = "jpo/navier-stokes",
      .title = "Incompressible Navier-Stokes",
      .citation = {.paper = "jpo", .where = "Sec. 4, Fig. 6, App. D.4"},
      .problem = recipe(),
      .setting = setting(),
      .profiles = {{.name = "smoke",
                    .rows = {row(kSingly, 4, 1, 5),
                             row(trained_methods(), 2, 1, 5)}},
                   {.name = "quick",
                    .rows = jpo_rows({16}, 1, kFitIterations, kSingly)},
                   {.name = "paper",
                    .rows = jpo_rows(
                        {4, 8, 16, 32, 64, 128}, 4, kFitIterations, kSingly)}},
      .methods = methods(),
      .styles = kJpoStyles,
  });
}

}  // namespace physinv::jpo::navier_stokes
