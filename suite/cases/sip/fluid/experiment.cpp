// SIP paper, App. B.4, Figs. 14 and 15: a network finds the velocity that a
// flow started with from a marker before and after.
#include <string>
#include <utility>
#include <vector>

#include "optimizers/classical.h"
#include "optimizers/local_steps.h"
#include "optimizers/training.h"
#include "optimizers/training/proxy.h"
#include "problems/marker_flow/marker_flow.h"
#include "suite/cases/sip/fluid/fluid.h"
#include "suite/cases/sip/fluid/metrics.h"
#include "suite/harness/registry.h"
#include "suite/nn/unet.h"

namespace physinv::fluid_case {
namespace {

constexpr Index kTest = 64, kUpdates = 1000;

Method trained(std::string id, Index batch, SignalRecipe signal) {
  return {.id = std::move(id),
          .chain = {train({.rule = AdamOptions{.rate = 5e-3, .eps = 1e-8},
                           .batch = batch,
                           .iterations = kUpdates,
                           .fresh = true,
                           .metrics = metrics(),
                           .signal = std::move(signal)})}};
}

/// The authors' batch is 64. inverse: the analytic estimate, fed with itself.
/// lbfgsb, gd: every example by itself, from no velocity.
std::vector<Method> methods() {
  std::vector<Method> all;
  for (const Index batch : {64, 16, 4}) {
    const std::string size = batch == 64 ? "" : "-b" + std::to_string(batch);
    all.push_back(trained("sip" + size, batch, inverse_proxy()));
    all.push_back(trained("adam" + size, batch, solver_loss()));
  }
  all.push_back({.id = "inverse",
                 .chain = {local_steps(
                     {.step = LocalStep::inverse_simulator, .rate = 1})}});
  all.push_back({.id = "lbfgsb", .chain = {lbfgsb_solve()}});
  all.push_back({.id = "gd", .chain = {gradient_descent_solve()}});
  return all;
}

std::vector<Profile> profiles(const Variant& variant) {
  const Row inverse = row({"inverse"}, 32, 1, 10);
  if (variant.timed_path)
    return {
        {.name = "quick", .rows = {inverse}},
        {.name = "standard", .rows = {inverse}},
        {.name = "paper", .rows = {row({"sip"}, kTest, 2, kUpdates), inverse}}};
  // The script's L-BFGS-B makes 16 iterations.
  const std::vector<Row> small = {row({"sip-b16", "adam-b16"}, 32, 1, 300),
                                  row({"lbfgsb"}, 32, 1, 16),
                                  row({"gd"}, 32, 1, 100),
                                  inverse};
  std::vector<Row> whole = small;
  whole.push_back(row({"sip", "adam"}, kTest, 2, kUpdates));
  return {{.name = "smoke",
           .rows = {row({"sip-b4", "adam-b4"}, 4, 1, 5),
                    row({"inverse", "lbfgsb", "gd"}, 4, 1, 2)}},
          {.name = "quick", .rows = small},
          {.name = "standard", .rows = small},
          {.name = "paper", .rows = whole},
          {.name = "long", .rows = {row({"sip", "adam"}, kTest, 1, kLong)}}};
}

Experiment experiment(const Variant& variant) {
  return {.name = variant.experiment,
          .title = variant.title,
          .citation = {.paper = "sip", .where = "App. B.4, Figs. 14, 15"},
          .problem = problems::marker_flow(
              {.cells = kCells, .timed_path = variant.timed_path}),
          .setting = {.predictor = {{Field::given, Field::observations},
                                    nn::unet({.grid = {kCells, kCells},
                                              .channels = 2,
                                              .levels = 5,
                                              .outputs = 2,
                                              .padding = nn::Padding::circular,
                                              .batch_statistics = true,
                                              .init = nn::Init::uniform})},
                      .recorded = 8},
          .profiles = profiles(variant),
          .methods = methods()};
}

}  // namespace

void add_experiments(Registry& r) {
  for (const Variant& v : {kCode, kTimed}) r.add(experiment(v));
}

}  // namespace physinv::fluid_case
