// SIP paper, App. C.2: a network learns to invert the exponential. The Newton
// steps are those of the authors' script and have no published numbers, nor
// have AdaHessian and Hessian-free, which the paper tries on other problems.
#include <string>
#include <utility>
#include <vector>

#include "optimizers/training.h"
#include "optimizers/training/newton.h"
#include "optimizers/training/proxy.h"
#include "optimizers/training/update_cosine.h"
#include "problems/exponential/exponential.h"
#include "suite/cases/sip/exponential/metrics.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"

namespace physinv::exponential {
namespace {

constexpr Index kPoints = 1000, kBatch = 100;
constexpr Index kSmoke = 200, kPaper = 10'000;
constexpr Index kCurvatureSmoke = 3, kCurvature = 200;

// Objectives are sums over the batch, not means. All estimates are recorded:
// those of a network in single precision are not made again to the last digits.
Method method(std::string id,
              decltype(TrainingOptions::rule) rule,
              SignalRecipe signal) {
  return {.id = std::move(id),
          .chain = {train({.rule = std::move(rule),
                           .batch = kBatch,
                           .iterations = kPaper,
                           .gradient_scale = double(kBatch),
                           .fresh = true,
                           .metrics = metrics(),
                           .signal = std::move(signal)})}};
}

/// norm: sign(exp x - y), which is that of x - log y. gt: x - log y.
std::vector<Method> methods() {
  constexpr AdamOptions adam{.rate = 1e-3, .eps = 1e-8};
  return {method("sgd", SgdOptions{.rate = 1e-2}, solver_loss()),
          method("adam", adam, solver_loss()),
          method("norm", adam, inverse_proxy(ProxyNorm::absolute)),
          method("gt", adam, inverse_proxy()),
          method("norm-cosines", adam, proxy_with_cosines(ProxyNorm::absolute)),
          method("adahessian", AdaHessianOptions{.rate = 1e-3}, solver_loss()),
          method("hf",
                 HessianFreeOptions{.solver = {.iterations = 50}},
                 solver_loss()),
          method("newton", adam, newton_proxy()),
          method("newton-clipped", adam, newton_proxy({.limit = 0.1})),
          method("newton-damped", adam, newton_proxy({.damping = 0.01}))};
}

}  // namespace

void add_experiments(Registry& r) {
  const std::vector<std::string> three = {"sgd", "adam", "norm"};
  const std::vector<Row> full = {row(three, kPoints, 10, kPaper),
                                 row({"gt",
                                      "newton",
                                      "newton-clipped",
                                      "newton-damped",
                                      "adahessian",
                                      "norm-cosines"},
                                     kPoints,
                                     3,
                                     kPaper),
                                 row({"hf"}, kPoints, 3, kCurvature)};
  r.add(Experiment{
      .name = "sip/exponential",
      .title = "Exponential",
      .citation = {.paper = "sip", .where = "App. C.2, Fig. 2"},
      .problem = problems::exponential(),
      .setting = {.predictor = {{Field::observations},
                                nn::mlp({.hidden = {16, 64, 16},
                                         .activation = nn::Activation::sigmoid,
                                         .init = nn::Init::uniform})}},
      .profiles =
          {{.name = "smoke",
            .rows = {row(three, kPoints, 1, kSmoke),
                     row({"adahessian", "hf"}, kPoints, 1, kCurvatureSmoke)}},
           {.name = "quick", .rows = {row(three, kPoints, 3, kPaper)}},
           {.name = "standard", .rows = full},
           {.name = "paper", .rows = full}},
      .methods = methods(),
  });
}

}  // namespace physinv::exponential
