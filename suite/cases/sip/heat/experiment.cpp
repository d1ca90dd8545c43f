// SIP paper, App. B.3, Figs. 10 to 13: a network finds the initial state of
// strong diffusion. Rates that paper and authors' script disagree on (SGD) are
// both here.

#include <string>
#include <utility>
#include <vector>

#include "optimizers/classical.h"
#include "optimizers/training.h"
#include "optimizers/training/late_loss.h"
#include "optimizers/training/proxy.h"
#include "optimizers/training/update_cosine.h"
#include "problems/heat/heat.h"
#include "suite/cases/sip/heat/direct.h"
#include "suite/cases/sip/heat/grids.h"
#include "suite/cases/sip/heat/metrics.h"
#include "suite/harness/registry.h"
#include "suite/nn/fno.h"
#include "suite/nn/unet.h"

namespace physinv::heat {
namespace {

constexpr Index kPaperSteps = 10'000, kStudy = 2'000;

const ProblemRecipe kProblem = problems::heat({.resolution = kSide});

enum class Push { solver, inverse, watched_inverse };

SignalRecipe signal(Push push) {
  constexpr auto kNorm = ProxyNorm::square;
  constexpr auto kPrecision = ProxyPrecision::in_double;
  if (push == Push::solver) return solver_loss();
  return push == Push::inverse ? inverse_proxy(kNorm, kPrecision)
                               : proxy_with_cosines(kNorm, kPrecision);
}

/// Objectives are sums over the batch, not means.
Method trained(std::string id,
               Push push,
               decltype(TrainingOptions::rule) rule,
               const GridPoint& cell,
               const LateError& late = {}) {
  return {.id = std::move(id),
          .chain = {train({.rule = std::move(rule),
                           .batch = cell.batch,
                           .iterations = kPaperSteps,
                           .gradient_scale = double(cell.batch),
                           .fresh = cell.set == 0,
                           .set = cell.set,
                           .metrics = metrics(),
                           .late = late,
                           .signal = signal(push)})}};
}

std::vector<Method> methods() {
  std::vector<Method> all;
  const auto both = [&](const GridPoint& cell, const LateError& late = {}) {
    const AdamOptions adam{.rate = cell.rate(), .eps = 1e-8};
    all.push_back(trained(cell.id("sip"), Push::inverse, adam, cell, late));
    all.push_back(trained(cell.id("adam"), Push::solver, adam, cell, late));
  };
  both({.batch = 8});
  all.push_back(trained("sip-cosines-b8",
                        Push::watched_inverse,
                        AdamOptions{.rate = 1e-3, .eps = 1e-8},
                        {.batch = 8}));
  for (const GridPoint& cell : rate_points()) both(cell);
  for (const GridPoint& cell : set_points()) both(cell);
  both(kGap, late_loss(kProblem));
  const auto sgd = [&](std::string id, Index batch, double rate) {
    all.push_back(trained(std::move(id),
                          Push::solver,
                          SgdOptions{.rate = rate},
                          {.batch = batch}));
  };
  sgd("sgd", 128, 2e-6), sgd("sgd-b4", 4, 2e-6);
  sgd("sgd-lr3", 128, 1e-3), sgd("sgd-b8-lr3", 8, 1e-3);
  sgd("sgd-b8-lr4", 8, 1e-4), sgd("sgd-b8-lr2", 8, 1e-2);
  for (const GridPoint& cell : rates_with({128, 8}))
    all.push_back(trained(cell.id("adahessian"),
                          Push::solver,
                          AdaHessianOptions{.rate = cell.rate()},
                          cell));
  all.push_back(
      trained("hf", Push::solver, HessianFreeOptions{}, {.batch = 128}));
  all.push_back(trained("hf-b4",
                        Push::solver,
                        HessianFreeOptions{.solver = {.iterations = 30}},
                        {.batch = 4}));
  all.push_back({"gd-cells", {direct({.solver = Direct::descent})}});
  all.push_back({"gd", {direct({.solver = Direct::descent_modes})}});
  all.push_back({"lbfgsb", {direct({.solver = Direct::lbfgsb_modes})}});
  all.push_back({"lbfgsb-cells", {lbfgsb_solve({.ftol = 1e-14})}});
  all.push_back(
      {"inverse-physics", {direct({.solver = Direct::inverse_physics_modes})}});
  all.push_back(
      {"inverse-physics-cells", {direct({.solver = Direct::inverse_physics})}});
  return all;
}

std::vector<Row> quick() {
  return {
      row({"gd", "lbfgsb"}, 64, 1, 1000),
      row({"gd-cells", "inverse-physics", "inverse-physics-cells"}, 64, 1, 100),
      row({"lbfgsb-cells"}, 64, 1, 20),
      row({"sip-b8", "adam-b8"}, 64, 3, 120),
      row({"sgd-b8-lr3"}, 64, 1, 20),
      row({"hf-b4"}, 64, 1, 9)};
}

/// The paper's questions about rates and about small sets, with batches of 8.
std::vector<Row> small_batches() {
  return {row({kGap.id("sip"), kGap.id("adam")}, 64, 3, 400),
          row({"adahessian-b8-lr2", "adahessian-b8", "adahessian-b8-lr4"},
              64,
              3,
              120),
          row({"sgd-b8-lr4"}, 64, 3, 120),
          row({"sgd-b8-lr2"}, 64, 1, 20)};
}

std::vector<Row> paper() {
  std::vector<std::string> studies;
  for (const auto& cells : {rate_points(), set_points()})
    for (const GridPoint& cell : cells)
      for (const char* method : {"sip", "adam"})
        if (const auto id = cell.id(method); id != method)
          studies.push_back(id);
  return {row({"gd", "lbfgsb"}, 128, 1, 1000),
          row({"inverse-physics", "gd-cells"}, 128, 1, 100),
          row({"lbfgsb-cells"}, 128, 1, 20),
          row({"sip", "adam", "sgd", "adahessian"}, 128, 3, kPaperSteps),
          row({"hf"}, 128, 1, 30),
          row({"hf-b4"}, 128, 1, 9),
          row({"sip-b8", "adam-b8"}, 128, 3, 120),
          row({"sip-cosines-b8"}, 64, 3, 120),
          row({"sgd-lr3", "sgd-b8-lr3"}, 128, 1, 20),
          row({"adahessian-lr2", "adahessian-lr4"}, 128, 3, kStudy),
          row(std::move(studies), 128, 1, kStudy)};
}

/// Paper, text: rate 1e-3; plotted runs of the authors' script: 1e-4.
std::vector<Method> operators() {
  std::vector<Method> all;
  const auto add = [&](const char* id, const GridPoint& cell) {
    all.push_back(trained(cell.id(id),
                          Push::solver,
                          AdamOptions{.rate = cell.rate(), .eps = 1e-8},
                          cell));
  };
  for (const GridPoint& cell : rates_with({128, 8})) add("fno", cell);
  for (const GridPoint& cell : rates_with({8})) add("fno-long", cell);
  return all;
}

Experiment with_operator(Experiment e) {
  e.name = kOperator;
  e.title = "Heat, Fourier neural operator";
  e.setting.predictor.recipe = nn::fno({.grid = {kSide, kSide}});
  e.methods = operators();
  const Row few = row({"fno-b8", "fno-b8-lr4"}, 64, 1, 26),
            rates = row({"fno-long-b8-lr2", "fno-long-b8", "fno-long-b8-lr4"},
                        64,
                        3,
                        100);
  e.profiles = {{.name = "quick", .rows = {few}},
                {.name = "standard",
                 .rows = {few, rates, row({"fno", "fno-lr4"}, 128, 1, 20)}},
                {.name = "paper",
                 .rows = {rates,
                          row({"fno", "fno-lr4"}, 128, 3, kPaperSteps),
                          row({"fno-lr2"}, 128, 3, kStudy)}}};
  return e;
}

}  // namespace

void add_experiments(Registry& r) {
  auto standard = joined(quick(), small_batches());
  standard.push_back(row({"sip-b32", "adam-b32"}, 64, 1, 1000));
  standard.push_back(row({"adahessian"}, 128, 1, 20));
  standard.push_back(row({"hf"}, 128, 1, 2));
  standard.push_back(row({"sip-cosines-b8"}, 64, 3, 120));
  const Experiment heat = {
      .name = kName,
      .title = "Heat",
      .citation = {.paper = "sip", .where = "App. B.3, Figs. 10 to 13"},
      .problem = kProblem,
      .setting = {.predictor = {{Field::observations},
                                nn::unet({.grid = {kSide, kSide},
                                          .padding = nn::Padding::circular,
                                          .batch_statistics = true,
                                          .init = nn::Init::uniform})},
                  .output_form = OutputForm::mean_of_observations,
                  .gtol = 1e-14,
                  .recorded = 4},
      .profiles = {{.name = "smoke",
                    .rows = {row({"gd",
                                  "gd-cells",
                                  "lbfgsb",
                                  "inverse-physics",
                                  "inverse-physics-cells"},
                                 4,
                                 1,
                                 10),
                             row({"sip-b4", "adam-b4", "sgd-b4"}, 4, 1, 10)}},
                   {.name = "quick", .rows = quick()},
                   {.name = "standard", .rows = std::move(standard)},
                   {.name = "paper", .rows = joined(paper(), small_batches())}},
      .methods = methods(),
  };
  r.add(heat);
  r.add(with_operator(heat));
}

}  // namespace physinv::heat
