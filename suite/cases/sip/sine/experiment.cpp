// SIP paper, App. B.1: networks learn to find where a stretched and turned sine
// has a value. All estimates are recorded: those of a network in single
// precision are not made again to the last digits.
#include <string>
#include <utility>
#include <vector>

#include "optimizers/training.h"
#include "optimizers/training/proxy.h"
#include "suite/cases/sip/sine/metrics.h"
#include "suite/cases/sip/sine/sine.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"

namespace physinv::sine {
namespace {

constexpr Index kProblems = 1000, kBatch = 100;
constexpr Index kSmoke = 200, kQuick = 8000, kSip = 15'000, kPlain = 50'000;

SinePlaneOptions options_of(const Point& p) {
  return {.xi = double(p.xi), .degrees = double(p.degrees)};
}

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

/// Rates of App. B.1, the other constants are PyTorch's defaults.
std::vector<Method> methods(const Point& p) {
  const Maker make{options_of(p)};
  const double xi = p.xi;
  const StepOptions adam = AdamOptions{.rate = 1e-3, .eps = 1e-8};
  std::vector<Method> all = {
      make("sip", adam, inverse_proxy(ProxyNorm::absolute)),
      make("sip-l2", adam, inverse_proxy(ProxyNorm::square)),
      make("adam", adam),
      make("sgd", SgdOptions{.rate = 1e-2 / (xi * xi)}),
      make("adadelta",
           AdadeltaOptions{.rate = 3e-3, .decay = 0.9, .eps = 1e-6}),
      make("adagrad",
           AdagradOptions{.rate = 3e-3, .accumulator = 0, .eps = 1e-10}),
      make("rmsprop",
           RmspropOptions{.rate = 3e-5, .decay = 0.99, .eps = 1e-8})};
  // The finite set of App. B: 1000 samples, again and again.
  all.push_back(
      make("sip-finite", adam, inverse_proxy(ProxyNorm::absolute), kProblems));
  all.push_back(make("adam-finite", adam, solver_loss(), kProblems));
  return all;
}

const std::vector<std::string> kInverse = {"sip", "sip-l2"};
const std::vector<std::string> kPlainOnes = {
    "adam", "sgd", "adadelta", "adagrad", "rmsprop"};

Row row(std::vector<std::string> ids, std::uint64_t seeds, Index updates) {
  return {.methods = std::move(ids),
          .n = {kProblems},
          .seeds = first_seeds(seeds),
          .iterations = updates};
}

std::vector<Profile> profiles(const Point& p) {
  const std::vector<Row> full = {row(kInverse, 3, kSip),
                                 row(kPlainOnes, 3, kPlain)};
  if (p.experiment() != kHard.experiment())
    return {{.name = "smoke"},
            {.name = "quick"},
            {.name = "standard"},
            {.name = "paper", .rows = full}};
  std::vector<Row> hard = full;
  hard.push_back(row({"sip-finite"}, 3, kSip));
  hard.push_back(row({"adam-finite"}, 3, kPlain));
  return {{.name = "smoke",
           .rows = {row(kInverse, 1, kSmoke), row(kPlainOnes, 1, kSmoke)}},
          {.name = "quick",
           .rows = {row(kInverse, 3, kQuick), row(kPlainOnes, 3, kQuick)}},
          {.name = "standard", .rows = hard},
          {.name = "paper", .rows = hard}};
}

const bool kRegistered = [] {
  bool all = true;
  for (const Point& p : points())
    all = register_experiment(
              {.name = p.experiment(),
               .title = fmt::format(
                   "Sine, xi = {}, phi = {} degrees", p.xi, p.degrees),
               .source = {.paper = "sip", .where = "App. B.1, Fig. 5"},
               .problem = problem<SinePlane>("sine_plane", options_of(p)),
               .setting = {.predictor = {{Field::observations},
                                         nn::mlp({.hidden = {32, 64, 32},
                                                  .init = nn::Init::uniform})}},
               .profiles = profiles(p),
               .methods = methods(p)}) &&
          all;
  return all;
}();

}  // namespace
}  // namespace physinv::sine
