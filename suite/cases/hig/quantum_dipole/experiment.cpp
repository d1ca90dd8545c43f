// HIG paper, Sec. 3.3, App. B.4, Figs. 4, 8 to 11, Table 5: a network learns
// which control steers a quantum state in a box to a given superposition, with
// dense layers and with convolutions.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "optimizers/training.h"
#include "problems/quantum_dipole/quantum_dipole.h"
#include "suite/cases/hig/common/jacobian_times.h"
#include "suite/cases/hig/common/methods.h"
#include "suite/cases/hig/quantum_dipole/grids.h"
#include "suite/cases/hig/quantum_dipole/metrics.h"
#include "suite/core/power_of_ten.h"
#include "suite/harness/registry.h"
#include "suite/nn/cnn.h"
#include "suite/nn/mlp.h"

namespace physinv::dipole {
namespace {

constexpr Index kTargets = 1024;
constexpr Index kChunk = 64;
constexpr Index kSlowAdam = 25'000;
/// Of the chain: where Adam alone has become slow, 244 epochs.
constexpr Index kBeforeHig = 15'616;

TrainingOptions training(decltype(TrainingOptions::rule) rule, Index batch) {
  // Controls and tapes of a batch of 1024 would take 20 MB.
  return {.rule = std::move(rule),
          .batch = batch,
          .chunk = kChunk,
          .metrics = levels()};
}

TrainingOptions by_adam(Index batch, double rate) {
  return training(AdamOptions{.rate = rate, .eps_before_correction = true},
                  batch);
}

TrainingOptions by_power(Index batch,
                         double rate,
                         double tau,
                         double kappa = -0.5) {
  return training(HalfInverseStepOptions{.power = {.kappa = kappa, .tau = tau},
                                         .rate = rate},
                  batch);
}

Method one(std::string id, const TrainingOptions& options) {
  return {.id = std::move(id), .chain = {train(options)}};
}

std::vector<Method> grids(const std::vector<AdamPoint>& adam,
                          const std::vector<HigPoint>& hig) {
  std::vector<Method> all;
  for (const HigPoint& p : hig)
    all.push_back(one(p.id, by_power(p.batch, p.rate, p.tau())));
  for (const AdamPoint& p : adam)
    all.push_back(one(p.id, by_adam(p.batch, p.rate)));
  return all;
}

std::vector<Method> dense_methods() {
  std::vector<Method> all = grids(dense_adam(), dense_hig());
  all.push_back(one("gn", by_power(16, 0.5, 1e-5, -1)));
  all.push_back(one("hig-b16-eta025-tau5", by_power(16, 0.25, 1e-5)));
  for (const double rate : {3e-4, 3e-3})
    all.push_back(one(adam_id(16, rate), by_adam(16, rate)));
  for (const FloatPoint& p : in_float()) {
    TrainingOptions options = by_power(16, 0.5, math::power_of_ten(-p.digits));
    options.project = p.project;
    all.push_back(one(p.id, options));
  }
  all.push_back(one("sgd", training(SgdOptions{.rate = 0.1}, 16)));
  all.push_back(one("adagrad", training(AdagradOptions{.rate = 0.01}, 16)));
  all.push_back(one("rmsprop", training(RmspropOptions{.rate = 1e-4}, 16)));
  TrainingOptions first = by_adam(16, 1e-4), second = by_power(16, 0.5, 1e-5);
  first.stage = "adam", first.iterations = kBeforeHig, first.own_length = true;
  second.stage = "hig";
  all.push_back({.id = "adam-hig", .chain = {train(first), train(second)}});
  return all;
}

// ---- registration -----------------------------------------------------------

constexpr RowOf row{.n = kTargets};
constexpr RowOf float_row{.n = kTargets, .precision = Precision::f32};

/// The grids' points but those with rows of their own.
template <class Grid>
std::vector<std::string> rest(const Grid& grid,
                              const std::vector<std::string>& without) {
  std::vector<std::string> ids;
  for (const auto& p : grid)
    if (std::find(without.begin(), without.end(), p.id) == without.end())
      ids.push_back(p.id);
  return ids;
}

const auto kThree = first_seeds(3), kFive = first_seeds(5);
const std::vector<std::string> kCuts = {"hig-b16-eta05-tau2",
                                        "hig-b16-eta05-tau3",
                                        "hig-b16-eta05-tau4",
                                        "hig-b16-eta05-tau6"};
const std::vector<std::string> kOthers = {"sgd", "adagrad", "rmsprop"};
/// For Table 5 alone.
const std::vector<std::string> kTimed = {
    "adam-b512-5e-4", "adam-b1024-5e-4", "hig-b8-eta05-tau5"};

NetworkRole dense() {
  return {{Field::observations},
          nn::mlp({.hidden = {20, 20, 20},
                   .activation = nn::Activation::tanh,
                   .init = nn::Init::glorot})};
}

NetworkRole convolutional() {
  return {{Field::observations},
          nn::cnn({.positions = kQuantumPoints,
                   .channels = 2,
                   .features = {20, 20, 20, 20, 20, 20}})};
}

std::vector<Profile> dense_profiles() {
  return {
      {.name = "smoke",
       .rows = {row({"hig", "gn"}, {0}, 64),
                row({"adam", "adam-b256-5e-4"}, {0}, 256)}},
      {.name = "quick",
       .rows = {row({"hig", "gn"}, kThree, 256),
                row({"adam-b256-5e-4"}, kThree, 960),
                row({"adam"}, kThree, 3000),
                row(kTimed, {0}, 32)}},
      {.name = "standard",
       .rows = {row({"hig", "gn"}, kFive, 512),
                row({"adam", "adam-b16-3e-3"}, kFive, kSlowAdam),
                row({"adam-b16-1e-3", "adam-b256-5e-4"}, kFive, 2000),
                row(kCuts, kFive, 256),
                row({"hig-b16-eta025-tau5", "hig-b16-eta10-tau5"}, kFive, 256),
                float_row(rest(in_float(), {}), kFive, 256),
                row(kOthers, kFive, 6000),
                row({"adam-hig"}, {0}, 512),
                row(kTimed, {0}, 64)}},
      {.name = "paper",
       .rows = {
           row({"hig", "gn"}, kFive, 9000),
           row({"adam-b256-5e-4"}, kFive, 13'500),
           row({"adam", "adam-b16-3e-4", "adam-b16-1e-3", "adam-b16-3e-3"},
               kFive,
               kSlowAdam),
           row({"hig-b16-eta025-tau5", "hig-b16-eta10-tau5"}, kFive, 9000),
           float_row(rest(in_float(), {}), kFive, 256),
           row(kOthers, kFive, kSlowAdam),
           row({"adam-hig"}, kFive, 512),
           row(rest(dense_hig(), {"hig", "hig-b16-eta10-tau5"}), kFive, 256),
           row(rest(dense_adam(), {"adam", "adam-b256-5e-4", "adam-b16-1e-3"}),
               kFive,
               2000)}}};
}

std::vector<Profile> conv_profiles() {
  return {{.name = "smoke", .rows = {row({"hig", "adam"}, {0}, 8)}},
          {.name = "quick", .rows = {row({"hig", "adam"}, {0}, 16)}},
          {.name = "standard",
           .rows = {row({"hig"}, kFive, 256), row({"adam"}, kFive, 600)}},
          {.name = "paper",
           .rows = {row({"hig"}, kFive, 9000),
                    row({"adam"}, kFive, 13'500),
                    row(rest(conv_hig(), {"hig"}), kFive, 256),
                    row(rest(conv_adam(), {"adam"}), kFive, 600)}}};
}

ProblemRecipe steered_by_a_network() {
  return problems::quantum_dipole({.zero_start = true});
}

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = kDense,
      .title = "Quantum dipole",
      .citation = {.paper = "hig", .where = "Sec. 3.3, Figs. 4, 8, 9, Table 5"},
      .problem = steered_by_a_network(),
      .setting = {.predictor = dense(), .recorded = 16},
      .profiles = dense_profiles(),
      .methods = dense_methods(),
  });
  r.add(Experiment{
      .name = kConvolutional,
      .title = "Quantum dipole, convolutional network",
      .citation = {.paper = "hig", .where = "App. B.4, Figs. 10, 11"},
      .problem = steered_by_a_network(),
      .setting = {.predictor = convolutional(), .recorded = 16},
      .profiles = conv_profiles(),
      .methods = grids(conv_adam(), conv_hig()),
  });
  hig::add_jacobian_times(r, kDense);
}

}  // namespace physinv::dipole
