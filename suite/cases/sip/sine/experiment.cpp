// SIP paper, App. B.1: networks learn to find where a stretched and turned sine
// has a value. All estimates are recorded: those of a network in single
// precision are not made again to the last digits.
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "optimizers/training.h"
#include "optimizers/training/proxy.h"
#include "optimizers/training/update_cosine.h"
#include "suite/cases/sip/sine/metrics.h"
#include "suite/cases/sip/sine/sine.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"

namespace physinv::sine {
namespace {

constexpr Index kProblems = 1000, kBatch = 100;
constexpr Index kSmoke = 200, kQuick = 8000, kSip = 15'000, kPlain = 50'000;

struct Maker {
  SinePlaneOptions problem;

  Method operator()(std::string id,
                    StepOptions rule,
                    SignalRecipe signal = solver_loss(),
                    Index set = 0) const {
    return {.id = std::move(id),
            .chain = {train({.rule = std::move(rule),
                             .batch = kBatch,
                             .iterations = kPlain,
                             .fresh = set == 0,
                             .set = set,
                             .metrics = metrics(problem),
                             .late = late_distance(problem),
                             .signal = std::move(signal)})}};
  }
};

struct Setup {
  std::string id;
  StepOptions rule;
  SignalRecipe signal = solver_loss();
};

/// Rates of App. B.1 times a factor; the other constants are PyTorch's
/// defaults.
std::vector<Setup> setups(double xi, double factor = 1) {
  const StepOptions adam = AdamOptions{.rate = factor * 1e-3, .eps = 1e-8};
  return {
      {"sip", adam, inverse_proxy(ProxyNorm::absolute)},
      {"adam", adam},
      {"sgd", SgdOptions{.rate = factor * 1e-2 / (xi * xi)}},
      {"adadelta",
       AdadeltaOptions{.rate = factor * 3e-3, .decay = 0.9, .eps = 1e-6}},
      {"adagrad",
       AdagradOptions{.rate = factor * 3e-3, .accumulator = 0, .eps = 1e-10}},
      {"rmsprop",
       RmspropOptions{.rate = factor * 3e-5, .decay = 0.99, .eps = 1e-8}}};
}

std::vector<Method> methods(const Point& p) {
  const Maker make{options_of(p)};
  std::vector<Method> all;
  for (const Setup& s : setups(p.xi))
    all.push_back(make(s.id, s.rule, s.signal));
  const StepOptions adam = AdamOptions{.rate = 1e-3, .eps = 1e-8};
  all.push_back(make("sip-l2", adam, inverse_proxy(ProxyNorm::square)));
  // The finite set of App. B: 1000 samples, again and again.
  all.push_back(
      make("sip-finite", adam, inverse_proxy(ProxyNorm::absolute), kProblems));
  all.push_back(make("adam-finite", adam, solver_loss(), kProblems));
  all.push_back(
      make("sip-cosines", adam, proxy_with_cosines(ProxyNorm::absolute)));
  return all;
}

const std::vector<std::string> kInverse = {"sip", "sip-l2"};
const std::vector<std::string> kPlainOnes = {
    "adam", "sgd", "adadelta", "adagrad", "rmsprop"};

std::vector<Profile> profiles(const Point& p) {
  const std::vector<Row> full = {row(kInverse, kProblems, 3, kSip),
                                 row(kPlainOnes, kProblems, 3, kPlain)};
  if (p.experiment() != kHard.experiment())
    return {{.name = "smoke"},
            {.name = "quick"},
            {.name = "standard"},
            {.name = "paper", .rows = full}};
  std::vector<Row> hard = full;
  hard.push_back(row({"sip-cosines"}, kProblems, 3, kQuick));
  hard.push_back(row({"sip-finite"}, kProblems, 3, kSip));
  hard.push_back(row({"adam-finite"}, kProblems, 3, kPlain));
  return {{.name = "smoke",
           .rows = {row(kInverse, kProblems, 1, kSmoke),
                    row(kPlainOnes, kProblems, 1, kSmoke)}},
          {.name = "quick",
           .rows = {row(kInverse, kProblems, 3, kQuick),
                    row(kPlainOnes, kProblems, 3, kQuick)}},
          {.name = "standard", .rows = hard},
          {.name = "paper", .rows = hard}};
}

Experiment experiment(std::string name,
                      std::string title,
                      const SinePlaneOptions& options) {
  return {.name = std::move(name),
          .title = std::move(title),
          .citation = {.paper = "sip", .where = "App. B.1, Fig. 5"},
          .problem = problems::sine_plane(options),
          .setting = {.predictor = {{Field::observations},
                                    nn::mlp({.hidden = {32, 64, 32},
                                             .init = nn::Init::uniform})}}};
}

Experiment sweep_point(const Point& p) {
  Experiment e = experiment(
      p.experiment(),
      fmt::format("Sine, xi = {}, phi = {} degrees", p.xi, p.degrees),
      options_of(p));
  e.profiles = profiles(p);
  e.methods = methods(p);
  return e;
}

/// All its methods, from the profile `standard` on.
Experiment study(Experiment e, std::vector<Method> methods) {
  e.citation.where = "App. B.1";
  std::vector<std::string> ids;
  for (const Method& m : methods) ids.push_back(m.id);
  const Row all = row(std::move(ids), kProblems, 3, kQuick);
  e.profiles = {{.name = "smoke"},
                {.name = "quick"},
                {.name = "standard", .rows = {all}},
                {.name = "paper", .rows = {all}}};
  e.methods = std::move(methods);
  return e;
}

Experiment study_of_gamma(int xi, int gamma) {
  const SinePlaneOptions options{.gamma = double(gamma), .xi = double(xi)};
  return study(
      experiment(gamma_study(xi, gamma),
                 fmt::format("Sine, xi = {}, gamma = {}", xi, gamma),
                 options),
      {Maker{options}("adam", AdamOptions{.rate = 1e-3, .eps = 1e-8})});
}

Experiment study_of_rates(int xi) {
  const SinePlaneOptions options{.xi = double(xi)};
  std::vector<Method> methods;
  for (const RateFactor& f : kFactors)
    for (const Setup& s : setups(xi, f.value))
      methods.push_back(
          Maker{options}(at_rate(s.id, f.name), s.rule, s.signal));
  return study(experiment(rate_study(xi),
                          fmt::format("Sine, xi = {}, learning rates", xi),
                          options),
               std::move(methods));
}

}  // namespace

void add_experiments(Registry& r) {
  for (const Point& p : points()) r.add(sweep_point(p));
  for (const int xi : kStudied) {
    r.add(study_of_rates(xi));
    for (const int gamma : kGammas) r.add(study_of_gamma(xi, gamma));
  }
}

}  // namespace physinv::sine
