// HIG paper, Sec. 3.1, App. B.2 and C, Figs. 2, 5, 6, 12, 13, Tables 2, 3: a
// network learns to bring two coupled oscillators back to where they started.
#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "optimizers/training.h"
#include "problems/oscillators/oscillators.h"
#include "suite/cases/hig/common/jacobian_times.h"
#include "suite/cases/hig/common/methods.h"
#include "suite/cases/hig/oscillators/ablation.h"
#include "suite/cases/hig/oscillators/oscillators.h"
#include "suite/evidence/options.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"
#include "suite/store/record.h"

namespace physinv::oscillators {
namespace {

// ---- methods ----------------------------------------------------------------

Method by_rule(std::string id, Index batch, StepOptions rule) {
  return {.id = std::move(id),
          .chain = {train({.rule = std::move(rule), .batch = batch})}};
}

Method by_power(std::string id, Index batch, hig::Power power) {
  return {.id = std::move(id),
          .chain = {train({.rule = HalfInverseStepOptions{.power = power},
                           .batch = batch})}};
}

StepOptions first_order(std::string_view rule, double rate) {
  if (rule == "adadelta") return AdadeltaOptions{.rate = rate};
  if (rule == "adagrad") return AdagradOptions{.rate = rate};
  if (rule == "sgd") return SgdOptions{.rate = rate};
  if (rule == "rmsprop") return RmspropOptions{.rate = rate};
  return AdamOptions{.rate = rate, .eps_before_correction = true};
}

std::vector<Method> made_methods() {
  std::vector<Method> all = {
      by_power("hig", 128, {.kappa = -0.5, .tau = 1e-6}),
      by_power("gn", 128, {.kappa = -1, .tau = 1e-6}),
      by_rule("adam", 512, first_order("adam", 3e-4)),
      by_rule("sgd", 512, first_order("sgd", 0.1)),
      by_rule("adagrad", 512, first_order("adagrad", 0.1)),
      by_rule("adadelta", 512, first_order("adadelta", 0.1)),
      by_rule("rmsprop", 512, first_order("rmsprop", 1e-4)),
      by_rule("adam-b256", 256, first_order("adam", 3e-4)),
      by_rule("adam-b1024", 1024, first_order("adam", 3e-4)),
      by_power("hig-b32", 32, {.kappa = -0.5, .tau = 1e-6}),
      by_power("gn-b32", 32, {.kappa = -1, .tau = 1e-6})};
  for (const AblationPoint& p : ablation_points())
    all.push_back(by_power(p.id, 64, p.power));
  for (const Grid& grid : kGrids)
    for (const double rate : grid.rates)
      for (const Index batch : kGridBatches)
        all.push_back(by_rule(grid_id(grid.rule, rate, batch),
                              batch,
                              first_order(grid.rule, rate)));
  return all;
}

/// Safe to use while statics are initialised.
const std::vector<Method>& methods() {
  static const auto kMethods = made_methods();
  return kMethods;
}

}  // namespace

std::string grid_id(const char* rule, double rate, Index batch) {
  return fmt::format("grid-{}-{}-b{}", rule, rate_id(rate), batch);
}

std::vector<std::string> ids_with(const std::string& beginning) {
  std::vector<std::string> ids;
  for (const Method& m : methods())
    if (m.id.starts_with(beginning)) ids.push_back(m.id);
  return ids;
}

std::string update_row(const Run& run) {
  const auto batch = number_of(run.stage->options, "batch");
  if (!batch) return {};
  const bool first_order = *batch >= 256;
  return fmt::format(
      "table3/{}/b={:.0f}/update", first_order ? "adam" : "hig", *batch);
}

namespace {

// ---- profiles ---------------------------------------------------------------

constexpr Index kStates = 4096;
// Updates; the paper trains for an hour, this many by its Table 3.
constexpr Index kQuick = 320, kStandard = 2000, kPaperSteps = 24'700;

constexpr RowOf row{.n = kStates};

const std::vector<std::string> kOthers = {
    "sgd", "adagrad", "adadelta", "rmsprop"};

std::vector<std::string> groups(const std::vector<std::string>& beginnings) {
  std::vector<std::string> ids;
  for (const auto& group : beginnings)
    for (const auto& id : ids_with(group)) ids.push_back(id);
  return ids;
}

const auto kThree = first_seeds(3), kFive = first_seeds(5);

const Setting kSetting{
    .predictor = {{Field::observations},
                  nn::mlp({.hidden = {20, 20, 20}, .init = nn::Init::glorot})},
    .recorded = 16};

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = kName,
      .title = "Nonlinear oscillators",
      .citation = {.paper = "hig", .where = "Sec. 3.1, Figs. 2, 5, 6, 12, 13"},
      .problem = problems::oscillators(),
      .setting = kSetting,
      .profiles =
          {{.name = "smoke",
            .rows = {row({"hig", "gn", "adam"}, {0}, 16),
                     row(kOthers, {0}, 16)}},
           {.name = "quick",
            .rows = {row({"hig", "gn"}, kThree, kQuick),
                     row({"adam"}, kThree, 2000),
                     row(kOthers, kThree, 300),
                     row({"kappa-05", "kappa-0", "kappa-m05", "kappa-m1"},
                         kFive,
                         256)}},
           {.name = "standard",
            .rows = {row({"hig"}, kFive, kStandard),
                     row({"gn"}, first_seeds(8), kStandard),
                     row({"adam"}, kFive, 40'000),
                     row(kOthers, kFive, 40'000),
                     row(groups({"hig-b", "gn-b"}), kFive, 1024),
                     row(groups({"adam-b"}), kFive, 4000),
                     row(groups({"kappa-", "beta-", "hig-tau", "gn-tau"}),
                         kFive,
                         1024),
                     row(groups({"grid-"}), {0}, 4000)}},
           {.name = "paper",
            .rows = {row({"hig"}, kFive, kPaperSteps),
                     row({"gn"}, first_seeds(8), kPaperSteps),
                     row({"adam"}, kFive, 44'400),
                     row(kOthers, kFive, 44'400),
                     row(groups({"hig-b", "gn-b"}), kFive, kPaperSteps),
                     row(groups({"adam-b"}), kFive, 44'400),
                     row(groups({"kappa-", "beta-", "hig-tau", "gn-tau"}),
                         kFive,
                         kPaperSteps),
                     row(groups({"grid-"}), {0}, 44'400)}}},
      .methods = methods(),
  });
  hig::add_jacobian_times(r, kName);
}

}  // namespace physinv::oscillators
