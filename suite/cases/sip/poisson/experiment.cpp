// SIP paper, App. B.2, Figs. 9 and 15: a network finds the source of a
// potential. The paper's grid is 80 x 60, that of the authors' code 64 x 64.
#include <string>
#include <utility>
#include <vector>

#include "optimizers/local_steps.h"
#include "optimizers/training.h"
#include "optimizers/training/proxy.h"
#include "optimizers/training/update_cosine.h"
#include "problems/poisson/poisson.h"
#include "suite/cases/sip/poisson/metrics.h"
#include "suite/cases/sip/poisson/poisson.h"
#include "suite/harness/registry.h"
#include "suite/nn/fno.h"
#include "suite/nn/unet.h"

namespace physinv::poisson {
namespace {

constexpr Index kTest = 128, kPaperUpdates = 10'000, kLong = 12'000;
constexpr Index kStudy = 2000;  ///< what the order of the methods needs
constexpr Index kHessians = 500;
constexpr double kSgd = 3e-12, kAdam = 1e-3, kHessian = 1e-6;
const std::vector<Index> kBatches = {128, 8};

/// Objectives are sums over the batch, not means.
Method trained(const Domain& domain,
               std::string id,
               Index batch,
               decltype(TrainingOptions::rule) rule,
               SignalRecipe signal = solver_loss()) {
  if (batch != kBatches.front()) id += "-b" + std::to_string(batch);
  return {.id = std::move(id),
          .chain = {train({.rule = std::move(rule),
                           .batch = batch,
                           .iterations = kPaperUpdates,
                           .gradient_scale = double(batch),
                           .fresh = true,
                           .metrics = metrics(),
                           .late = late_error(domain.rows, domain.columns),
                           .signal = std::move(signal)})}};
}

std::vector<Method> methods(const Domain& domain) {
  std::vector<Method> all;
  const auto adam = [](double rate) {
    return StepOptions(AdamOptions{.rate = rate, .eps = 1e-8});
  };
  const auto sgd = [](double rate) {
    return StepOptions(SgdOptions{.rate = rate, .momentum = 0.9});
  };
  for (const Index batch : kBatches) {
    const auto add = [&](std::string id, auto rule, auto... signal) {
      all.push_back(trained(
          domain, std::move(id), batch, std::move(rule), std::move(signal)...));
    };
    add("sip", adam(kAdam), inverse_proxy());
    add("sip-cosines", adam(kAdam), proxy_with_cosines());
    add("sip-10x", adam(10 * kAdam), inverse_proxy());
    add("adam", adam(kAdam));
    add("adam-10x", adam(10 * kAdam));
    add("sgd", sgd(kSgd));
    add("sgd-10x", sgd(10 * kSgd));
    add("adahessian", AdaHessianOptions{.rate = kHessian});
    add("adahessian-lr7", AdaHessianOptions{.rate = 1e-7});
    add("adahessian-lr5", AdaHessianOptions{.rate = 1e-5});
    add("adahessian-lr4", AdaHessianOptions{.rate = 1e-4});
    add("adahessian-power1", AdaHessianOptions{.rate = kHessian, .power = 1});
    add("hf", HessianFreeOptions{});
    add("hf-40", HessianFreeOptions{.solver = {.iterations = 40}});
    add("hf-10", HessianFreeOptions{.solver = {.iterations = 10}});
  }
  const Index few = kBatches.back();
  for (const int times : {16, 160})
    all.push_back(trained(
        domain, "sgd-" + std::to_string(times) + 'x', few, sgd(times * kSgd)));
  all.push_back(trained(domain, "sip-long", few, adam(kAdam), inverse_proxy()));
  all.push_back(trained(domain, "adam-long", few, adam(kAdam)));
  const auto direct = [&](std::string id, LocalStep step, double rate) {
    all.push_back({.id = std::move(id),
                   .chain = {local_steps(
                       {.step = step, .rate = rate, .iterations = 300})}});
  };
  direct("gd", LocalStep::gradient, 2e-5);
  direct("gd-5e-5", LocalStep::gradient, 5e-5);
  direct("inverse-physics", LocalStep::inverse_simulator, 1);
  direct("inverse-physics-300", LocalStep::inverse_simulator, 1);
  const auto direct_adam = [&](std::string id, double rate) {
    all.push_back(
        {.id = std::move(id),
         .chain = {local_steps({.iterations = 300, .rule = adam(rate)})}});
  };
  direct_adam("direct-adam-lr3", 1e-3);
  direct_adam("direct-adam-lr2", 1e-2);
  direct_adam("direct-adam-lr1", 1e-1);
  return all;
}

std::vector<Row> directly(Index n) {
  return {row({"gd"}, n, 1, 300, Precision::f64),
          row({"gd-5e-5"}, n, 1, 200, Precision::f64),
          row({"direct-adam-lr3", "direct-adam-lr2", "direct-adam-lr1"},
              n,
              1,
              300,
              Precision::f64),
          row({"inverse-physics-300"}, n, 1, 300, Precision::f64),
          row({"inverse-physics"}, n, 1, 1, Precision::f64),
          row({"inverse-physics"}, n, 1, 1)};
}

/// The paper's questions about rates, with batches of 8.
const std::vector<Row> kRates = {row({"sgd-16x-b8", "sgd-160x-b8"}, 32, 3, 200),
                                 row({"adahessian-b8",
                                      "adahessian-lr7-b8",
                                      "adahessian-lr5-b8",
                                      "adahessian-lr4-b8",
                                      "adahessian-power1-b8"},
                                     32,
                                     3,
                                     150)};
const std::vector<Row> kSmallRates = {row(
    {"sip-long-b8", "adam-long-b8", "sip-10x-b8", "adam-10x-b8"}, 64, 3, 600)};
const std::vector<Row> kFullRates = {
    row({"sip-10x", "adam-10x", "sgd-10x"}, kTest, 3, kStudy),
    row({"adahessian-lr7",
         "adahessian-lr5",
         "adahessian-lr4",
         "adahessian-power1"},
        kTest,
        3,
        kHessians)};

std::vector<Profile> profiles(const Domain& domain) {
  const std::string name = domain.experiment;
  if (name == kSmall.experiment) {
    const std::vector<Row> quick = {row({"sip-b8", "adam-b8"}, 32, 1, 160),
                                    row({"sgd-b8"}, 32, 1, 170),
                                    row({"adahessian-b8"}, 32, 1, 70),
                                    row({"hf-40-b8"}, 32, 1, 2)};
    return {{.name = "smoke",
             .rows = {row({"sip-b8", "adam-b8", "sgd-b8"}, 8, 1, 10),
                      row({"hf-10-b8"}, 8, 1, 1),
                      row({"gd"}, 1, 1, 50, Precision::f64)}},
            {.name = "quick", .rows = quick},
            {.name = "standard", .rows = joined(quick, kSmallRates)},
            {.name = "paper", .rows = joined(quick, kSmallRates)}};
  }
  if (name == kPaper.experiment) {
    return {
        {.name = "quick", .rows = directly(8)},
        {.name = "standard", .rows = directly(8)},
        {.name = "paper",
         .rows = joined(directly(8), {row({"sip", "adam"}, kTest, 1, kLong)})}};
  }
  const std::vector<Row> quick =
      joined(directly(8), {row({"sip-b8", "adam-b8"}, 32, 3, 120)});
  const Row cosines = row({"sip-cosines-b8"}, 32, 3, 120);
  return {{.name = "quick", .rows = quick},
          {.name = "standard",
           .rows = joined(joined(quick, kRates),
                          {row({"sip", "adam", "sgd"}, kTest, 1, kStudy),
                           row({"adahessian"}, kTest, 1, 20),
                           row({"hf"}, kTest, 1, 2),
                           cosines})},
          {.name = "paper",
           .rows = joined(joined(directly(8), joined(kRates, kFullRates)),
                          {row({"sip", "adam"}, kTest, 3, kLong),
                           row({"sgd", "adahessian"}, kTest, 3, kPaperUpdates),
                           row({"hf"}, kTest, 1, 6),
                           row({"sip-b8", "adam-b8"}, 32, 3, 120),
                           cosines})}};
}

Experiment experiment(const Domain& p) {
  return {.name = p.experiment,
          .title = p.title,
          .citation = {.paper = "sip", .where = "App. B.2, Figs. 9, 15"},
          .problem = problems::poisson({.rows = p.rows, .columns = p.columns}),
          .setting = {.predictor = {{Field::observations},
                                    nn::unet({.grid = {p.columns, p.rows},
                                              .padding = nn::Padding::circular,
                                              .batch_statistics = true,
                                              .init = nn::Init::uniform})},
                      .recorded = 8},
          .profiles = profiles(p),
          .methods = methods(p)};
}

/// Fourier neural operator: another network, so another experiment.
Experiment operator_experiment(const Domain& domain, Index width) {
  Experiment e = experiment(domain);
  e.setting.predictor.recipe = nn::fno({.grid = {64, 64}, .width = width});
  e.methods.clear();
  const auto add = [&](const char* id, Index batch) {
    e.methods.push_back(
        trained(domain,
                id,
                batch,
                StepOptions(AdamOptions{.rate = 3e-3, .eps = 1e-8})));
  };
  for (const Index batch : kBatches) add("fno", batch);
  add("fno-long", kBatches.back());
  return e;
}

Experiment wide_operator() {
  Experiment e = operator_experiment(kFno, 32);
  const Row quick = row({"fno-b8"}, 32, 1, 40),
            longer = row({"fno-long-b8"}, 64, 3, 100);
  e.profiles = {
      {.name = "quick", .rows = {quick}},
      {.name = "standard", .rows = {quick, longer, row({"fno"}, kTest, 1, 20)}},
      {.name = "paper",
       .rows = {longer, row({"fno"}, kTest, 3, kPaperUpdates)}}};
  return e;
}

/// A smaller version, to be compared after the same time.
Experiment narrow_operator() {
  Experiment e = operator_experiment(kNarrow, 16);
  const Row longer = row({"fno-long-b8"}, 64, 3, 300);
  e.profiles = {{.name = "standard", .rows = {longer}},
                {.name = "paper",
                 .rows = {longer, row({"fno"}, kTest, 3, 2 * kPaperUpdates)}}};
  return e;
}

}  // namespace

void add_experiments(Registry& r) {
  r.add(wide_operator());
  r.add(narrow_operator());
  for (const Domain& p : {kPlane, kSmall, kPaper}) r.add(experiment(p));
}

}  // namespace physinv::poisson
