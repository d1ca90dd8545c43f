// HIG paper, Sec. 3.2, App. B.3 and C, Figs. 3, 7, Table 4: a network learns
// the potentials of sources on an 8 x 8 grid, with fresh data at every update.
#include <cmath>
#include <string>
#include <vector>

#include "optimizers/training.h"
#include "problems/grid_poisson/grid_poisson.h"
#include "suite/cases/hig/common/methods.h"
#include "suite/cases/hig/common/report.h"
#include "suite/cases/hig/poisson/claims.h"
#include "suite/cases/hig/poisson/tables.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"

namespace physinv {
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

// ---- report -----------------------------------------------------------------

std::vector<MethodLine> learning(const Published& published) {
  const auto adam = paper_update(published, poisson::kName, "table4/adam/b=64"),
             hig = paper_update(published, poisson::kName, "table4/hig/b=64");
  return {{"adam", "Adam 1e-4", "gd", adam},
          {"adam-3e-4", "Adam 3e-4", "adam-3e-4", adam},
          {"adam-1e-3", "Adam 1e-3", "adam-1e-3", adam},
          {"hig-001-b64", "HIG 0.01", "hig-001", hig},
          {"hig-002-b64", "HIG 0.02", "jpo", hig},
          {"hig-005-b64", "HIG 0.05", "hig-005", hig},
          {"gn-002-b64", "GN 0.02", "bfgs"},
          {"gn-1-b64", "GN 1", "gn-1"},
          {"hig-001-b16", "HIG 0.01, b = 16", "hig-001-b16"},
          {"hig-002-b16", "HIG 0.02, b = 16", "supervised"},
          {"hig-005-b16", "HIG 0.05, b = 16", "hig-005-b16"},
          {"gn-002-b16", "GN 0.02, b = 16", "na"},
          {"gn-1-b16", "GN 1, b = 16", "gn-1-b16"},
          {"hig-b4", "HIG 0.02, b = 4", "hig-b4"},
          {"gn-b4", "GN 0.02, b = 4", "gn-b4"}};
}

/// From weights that Adam has trained.
std::vector<MethodLine> turns(const Published& published) {
  const auto adam = paper_update(published, poisson::kName, "table4/adam/b=64"),
             hig = paper_update(published, poisson::kName, "table4/hig/b=64");
  return {{"adam-adam", "Adam, Adam", "gd", adam},
          {"adam-hig-0001-b16", "Adam, HIG 0.001, b = 16", "hig-001"},
          {"adam-hig-0005-b16", "Adam, HIG 0.005, b = 16", "hig-005"},
          {"adam-hig-002-b16", "Adam, HIG 0.02, b = 16", "supervised"},
          {"adam-hig-002-b64", "Adam, HIG 0.02", "jpo", hig},
          {"long-adam-adam", "Adam, Adam, later", "adam-3e-4", adam},
          {"long-adam-hig", "Adam, HIG 0.02, later", "na", hig}};
}

const std::vector<MethodLine> kReturns = {
    {"adam", "Adam, uninterrupted", "truth"},
    {"adam-adam", "Adam, Adam", "gd"},
    {"adam-hig-adam", "Adam, HIG, Adam", "jpo"},
    {"long-adam-adam", "Adam, Adam, later", "adam-3e-4"},
    {"long-adam-hig-adam", "Adam, HIG, Adam, later", "na"},
    {"chain-smoke", "Adam, HIG, Adam, short", "chain-smoke"}};

Section report(const Results& results, const Published& published) {
  const poisson::Runs runs(results);
  const auto fresh = learning(published), turned = turns(published);
  std::vector<MethodLine> all = fresh;
  for (const auto* group : {&turned, &kReturns})
    for (const MethodLine& line : *group)
      if (line.method != "adam" && line.method != "adam-adam" &&
          line.method != "long-adam-adam")
        all.push_back(line);
  Section section{
      .experiment = poisson::kName,
      .title = "Poisson's equation",
      .paper = "hig",
      .tables = {loss_table(results, poisson::kName, all),
                 cost_table(results,
                            poisson::kName,
                            published,
                            {{"adam", "Adam, b = 64", "table4/adam/b=64"},
                             {"hig-002-b64", "HIG, b = 64", "table4/hig/b=64"},
                             {"adam-hig-002-b64",
                              "HIG after Adam, b = 64",
                              "table4/hig/b=64"},
                             {"hig-002-b16", "HIG, b = 16", ""}},
                            "Table 4"),
                 poisson::spectrum_table(runs),
                 poisson::crossing_table(runs)},
      .claims = poisson::claims(runs)};
  LearningCurves curves(results, section);
  const auto some = [&](std::initializer_list<const char*> ids) {
    std::vector<MethodLine> lines;
    for (const MethodLine& line : fresh)
      for (const char* id : ids)
        if (line.method == id) lines.push_back(line);
    return lines;
  };
  curves.losses(some({"adam",
                      "adam-3e-4",
                      "adam-1e-3",
                      "hig-001-b64",
                      "hig-002-b64",
                      "hig-005-b64"}),
                "fig3b",
                "Learning curves, b = 64",
                "Figs. 3b, 7a");
  curves.losses(some({"adam",
                      "hig-002-b16",
                      "hig-002-b64",
                      "gn-002-b16",
                      "gn-1-b16",
                      "gn-002-b64",
                      "gn-1-b64",
                      "hig-b4",
                      "gn-b4"}),
                "fig7a",
                "Small batches, and Gauss-Newton beside HIG",
                "Fig. 7a");
  curves.losses(
      turned, "fig3c", "From weights that Adam has trained", "Fig. 3c");
  curves.chains(
      kReturns, "fig7b", "Adam, then HIG, then Adam again", "Fig. 7b");
  return section;
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
         row({"long-adam-hig"}, kFive, 60),
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

const auto kRegistered = register_experiment({
    .name = poisson::kName,
    .title = "Poisson's equation",
    .source = {.paper = "hig", .where = "Sec. 3.2, Figs. 3, 7, Table 4"},
    .problem = problem<GridPoisson>("grid_poisson"),
    .setting = kSetting,
    .profiles = kProfiles,
    .methods = methods(),
    .report = report,
});

}  // namespace
}  // namespace physinv
