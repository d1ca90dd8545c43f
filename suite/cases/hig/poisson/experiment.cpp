// HIG paper, Sec. 3.2, App. B.3 and C, Figs. 3, 7, Table 4: a network learns
// the potentials of sources on an 8 x 8 grid, with fresh data at every update.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "optimizers/training.h"
#include "problems/grid_poisson/grid_poisson.h"
#include "suite/cases/hig/common/jacobian_times.h"
#include "suite/cases/hig/common/methods.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"

namespace physinv::hig::poisson {
namespace {

constexpr Index kEvaluation = 1024, kBatch = 64;
constexpr double kTau = 1e-5;
/// Updates before a chain turns to HIG, and those with HIG in the middle.
constexpr Index kPretrained = 5000, kDetour = 60;
constexpr Index kPaperPretrained = 30'000, kPaperDetour = 20;
/// An hour by the paper's Table 4.
constexpr Index kPaperAdam = 327'000, kPaperHig = 261;

// ---- methods ----------------------------------------------------------------

TrainingOptions adam(double rate, std::string stage = "adam") {
  return {.stage = std::move(stage),
          .rule = AdamOptions{.rate = rate, .eps_before_correction = true},
          .batch = kBatch,
          .fresh = true};
}

/// g = y - rho without 1/b: the gradient of the batch's sum.
TrainingOptions power(double kappa, double rate, Index batch) {
  return {.stage = "hig",
          .rule = HalfInverseStepOptions{.power = {.kappa = kappa, .tau = kTau},
                                         .rate = rate},
          .batch = batch,
          .gradient_scale = static_cast<double>(batch),
          .fresh = true};
}

TrainingOptions of_length(TrainingOptions stage, Index updates) {
  stage.iterations = updates;
  stage.own_length = true;
  return stage;
}

/// Rows set the length of the last stage only.
Method chain(std::string id, const std::vector<TrainingOptions>& stages) {
  Method method{.id = std::move(id), .chain = {}};
  for (const auto& stage : stages) method.chain.push_back(train(stage));
  return method;
}

struct Rate {
  const char* id;
  double eta;
};
constexpr Rate kHigRates[] = {{"001", 0.01}, {"002", 0.02}, {"005", 0.05}};
constexpr Rate kLaterRates[] = {
    {"0001", 0.001}, {"0005", 0.005}, {"002", 0.02}};

std::vector<Method> methods() {
  std::vector<Method> all = {chain("adam", {adam(1e-4)}),
                             chain("adam-3e-4", {adam(3e-4)}),
                             chain("adam-1e-3", {adam(1e-3)}),
                             chain("hig-b4", {power(-0.5, 0.02, 4)}),
                             chain("gn-b4", {power(-1, 0.02, 4)})};
  for (const Index b : {16, 64}) {
    for (const Rate& r : kHigRates)
      all.push_back(
          chain(fmt::format("hig-{}-b{}", r.id, b), {power(-0.5, r.eta, b)}));
    all.push_back(chain(fmt::format("gn-002-b{}", b), {power(-1, 0.02, b)}));
    all.push_back(chain(fmt::format("gn-1-b{}", b), {power(-1, 1, b)}));
  }

  const auto first = of_length(adam(1e-4), kPretrained);
  const auto again = adam(1e-4, "again");
  for (const Index b : {16, 64})
    for (const Rate& r : kLaterRates)
      all.push_back(chain(fmt::format("adam-hig-{}-b{}", r.id, b),
                          {first, power(-0.5, r.eta, b)}));
  all.push_back(chain("adam-adam", {first, again}));
  all.push_back(
      chain("adam-hig-adam",
            {first, of_length(power(-0.5, 0.02, 16), kDetour), again}));

  const auto longer = of_length(adam(1e-4), kPaperPretrained);
  all.push_back(chain("long-adam-hig", {longer, power(-0.5, 0.02, 64)}));
  all.push_back(chain("long-adam-adam", {longer, again}));
  all.push_back(
      chain("long-adam-hig-adam",
            {longer, of_length(power(-0.5, 0.02, 64), kPaperDetour), again}));

  all.push_back(chain(
      "chain-smoke",
      {of_length(adam(1e-4), 40), of_length(power(-0.5, 0.02, 4), 2), again}));
  return all;
}

// ---- profiles ---------------------------------------------------------------

constexpr RowOf row{.n = kEvaluation};

const auto kThree = first_seeds(3), kFive = first_seeds(5);

const std::vector<Profile> kProfiles = {
    {.name = "smoke",
     .rows = {row({"adam"}, {0}, 200),
              row({"hig-b4", "gn-b4"}, {0}, 3),
              row({"chain-smoke"}, {0}, 20)}},
    {.name = "quick",
     .rows = {row({"adam"}, kThree, 3000),
              row({"hig-002-b16"}, kThree, 60),
              row({"gn-002-b16", "gn-1-b16"}, kThree, 20)}},
    {.name = "standard",
     .rows =
         {row({"adam"}, kFive, 20'000),
          row({"adam-3e-4", "adam-1e-3"}, kFive, 5000),
          row({"hig-002-b16", "gn-002-b16", "gn-1-b16"}, kFive, 400),
          row({"adam-hig-0001-b16", "adam-hig-0005-b16", "adam-hig-002-b16"},
              kFive,
              60),
          row({"adam-hig-002-b64"}, kFive, 3),
          row({"adam-adam", "adam-hig-adam"}, kFive, 3000)}},
    {.name = "paper",
     .rows = {
         row({"adam", "adam-3e-4", "adam-1e-3"}, kFive, kPaperAdam),
         row({"hig-001-b64", "hig-002-b64", "hig-005-b64"}, kFive, kPaperHig),
         row({"gn-002-b64", "gn-1-b64"}, kFive, kPaperHig),
         row({"adam-hig-0001-b64", "adam-hig-0005-b64", "adam-hig-002-b64"},
             kFive,
             60),
         row({"adam-hig-002-b16", "long-adam-hig"}, kFive, 60),
         row({"adam-adam"}, kFive, kPaperPretrained),
         row({"long-adam-adam", "long-adam-hig-adam"},
             kFive,
             kPaperPretrained)}}};

const Setting kSetting{
    .predictor = {{Field::observations},
                  nn::mlp({.hidden = {64, 256, 64},
                           .activation = nn::Activation::tanh,
                           .init = nn::Init::glorot})},
    .recorded = 16};

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = "hig/poisson",
      .title = "Poisson's equation",
      .citation = {.paper = "hig", .where = "Sec. 3.2, Figs. 3, 7, Table 4"},
      .problem = problems::grid_poisson(),
      .setting = kSetting,
      .profiles = kProfiles,
      .methods = methods(),
  });
  add_jacobian_times(r, "hig/poisson");
}

}  // namespace physinv::hig::poisson
