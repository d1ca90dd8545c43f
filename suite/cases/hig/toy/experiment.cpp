// HIG paper, Secs. 2.1, 2.2, App. B.1, Fig. 1: a small network fits
// (sin 6x, cos 9x) through a physics that scales its second output by gamma.
#include <string>
#include <vector>

#include "optimizers/training.h"
#include "problems/scaled_output/scaled_output.h"
#include "suite/cases/hig/common/methods.h"
#include "suite/cases/hig/toy/metrics.h"
#include "suite/cases/hig/toy/toy.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"

namespace physinv::toy {
namespace {

constexpr Index kPoints = 1024, kBatch = 256;
constexpr Index kSmoke = 80, kUpdates = 1600, kPaper = 16'000;

// ---- methods ----------------------------------------------------------------

constexpr hig::Power kHig{.kappa = -0.5, .tau = 1e-6};
constexpr hig::Power kGaussNewton{.kappa = -1, .tau = 1e-4};
constexpr hig::Power kSameCut{.kappa = -1, .tau = 1e-6};

hig::Power with_absolute_cut(hig::Power power) {
  power.absolute = true;
  return power;
}

std::vector<Method> methods(double gamma) {
  std::vector<Method> all;
  const auto add = [&](std::string id, auto rule, double gradient_scale) {
    all.push_back({.id = std::move(id),
                   .chain = {train({.rule = std::move(rule),
                                    .batch = kBatch,
                                    .gradient_scale = gradient_scale,
                                    .metrics = metrics(gamma)})}});
  };
  const auto power = [](const hig::Power& p) {
    return HalfInverseStepOptions{.power = p};
  };
  // Adam takes the gradient of the mean loss, all others twice that.
  add("adam",
      StepOptions(AdamOptions{.rate = 0.3, .eps_before_correction = true}),
      1);
  add("gn", power(kGaussNewton), 2);
  add("hig", power(kHig), 2);
  add("sgd", StepOptions(SgdOptions{.rate = 0.1}), 2);
  add("gn_tau6", power(kSameCut), 2);
  add("hig_absolute", power(with_absolute_cut(kHig)), 2);
  add("gn_absolute", power(with_absolute_cut(kGaussNewton)), 2);
  // The gradient by the outputs as a batch mean, and as a plain sum.
  add("hig_mean", power(kHig), 1);
  add("gn_mean", power(kGaussNewton), 1);
  add("hig_sum", power(kHig), double(kBatch));
  add("gn_sum", power(kGaussNewton), double(kBatch));
  return all;
}

// ---- profiles ---------------------------------------------------------------

std::vector<Profile> profiles(const Gamma& gamma) {
  const std::vector<std::string> five = {"adam", "gn", "hig", "sgd", "gn_tau6"};
  constexpr RowOf row{.n = kPoints};
  std::vector<Profile> all = {
      {.name = "smoke", .rows = {row(five, first_seeds(3), kSmoke)}},
      {.name = "quick", .rows = {row(five, first_seeds(5), kUpdates)}},
      {.name = "standard", .rows = {row(five, first_seeds(24), kUpdates)}},
      {.name = "paper", .rows = {row(five, first_seeds(24), kPaper)}}};
  if (gamma.value == 0.01) {
    for (Profile& p : all) {
      if (p.name != "standard" && p.name != "paper") continue;
      const auto twelve = first_seeds(12);
      p.rows.push_back(
          row({"hig_absolute", "gn_absolute"}, twelve, kUpdates / 2));
      p.rows.push_back(row({"hig_mean", "gn_mean"}, twelve, kUpdates));
      p.rows.push_back(row({"hig_sum", "gn_sum"}, twelve, kUpdates / 4));
    }
  }
  return all;
}

}  // namespace

void add_experiments(Registry& r) {
  for (const Gamma& gamma : kGammas) {
    r.add(Experiment{
        .name = gamma.experiment,
        .title = gamma.title,
        .citation = {.paper = "hig",
                     .where = "Secs. 2.1, 2.2, App. B.1, Fig. 1"},
        .problem = problems::scaled_output({.gamma = gamma.value}),
        .setting = {.predictor = {{Field::given},
                                  nn::mlp({.hidden = {kHidden},
                                           .activation = nn::Activation::tanh,
                                           .init = nn::Init::glorot})},
                    .recorded = 16},
        .profiles = profiles(gamma),
        .methods = methods(gamma.value),
    });
  }
}

}  // namespace physinv::toy
