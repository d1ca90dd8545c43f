// JPO paper, App. D.5, Fig. 25: an underdetermined problem with a loss like a
// bowl, where joint optimization needs no advantage over BFGS and shows none.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "problems/robotic_arm/robotic_arm.h"
#include "suite/cases/jpo/common/endings.h"
#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"

namespace physinv {
namespace {

constexpr const char* kName = "jpo/robotic-arm";
constexpr double kSolved = 1e-12;
constexpr Index kFitIterations = 2000;

const auto kTrained = trained_methods();

double solved(const StageRecord& s) { return share_below(s.loss, kSolved); }

ClaimResult bfgs_solves(const JpoMetrics& metrics) {
  const Endings bfgs(metrics, "bfgs", false);
  const auto losses = bfgs.all(&StageRecord::loss);
  std::optional<double> exact;
  if (!losses.empty()) {
    const auto below = std::count_if(
        losses.begin(), losses.end(), [](double l) { return l <= 1e-18; });
    exact = static_cast<double>(below) / static_cast<double>(losses.size());
  }
  Judge judge;
  judge.at_least("lowest share solved", bfgs.smallest(solved), 1)
      .at_least("median iterations", bfgs.median_iterations(), 6)
      .at_most("median iterations", bfgs.median_iterations(), 14)
      .at_least("share with L <= 1e-18", exact, 0.95);
  return std::move(judge).result(
      "R2",
      "BFGS solves every problem of every n and seed (L < 1e-12) in a median "
      "of 6 to 14 iterations, at least 95 % of them down to L <= 1e-18",
      "smoke");
}

/// Of all targets that gradient descent misses, the one farthest from full
/// stretch: how far the tip would have to come in. 0 if it misses none.
double slack_of_misses(const Results& results) {
  double slack = 0;
  for (const CaseRecord& c : results.cases()) {
    if (c.info.experiment != kName || c.info.method != "gd") continue;
    for (const StageRecord& s : c.stages)
      for (Index i = 0; i < s.loss.size(); ++i)
        if (!(s.loss[i] < kSolved))
          slack = std::max(slack, 2 - std::abs(c.data.y(0, i)));
  }
  return slack;
}

ClaimResult descent_solves(const Results& results,
                           const JpoMetrics& metrics,
                           bool complete) {
  Judge judge;
  if (!complete) {
    judge.missing("gradient descent with all its iterations");
  } else {
    const Endings gd(metrics, "gd", false), bfgs(metrics, "bfgs", false);
    judge.at_least("lowest share solved", gd.smallest(solved), 1)
        .at_most("most iterations",
                 gd.largest([](const StageRecord& s) {
                   return s.example_iterations.maxCoeff();
                 }),
                 1000)
        .above("median iterations over those of BFGS",
               gd.median_iterations(),
               bfgs.median_iterations());
    judge.report(
        "share solved of all problems",
        metrics.pooled_solved_share("gd", metrics.sizes(), false, kSolved));
    if (const double slack = slack_of_misses(results); slack > 0)
      judge.report("targets of the others end before full stretch by at most",
                   slack);
  }
  return std::move(judge).result(
      "R3",
      "Gradient descent solves every problem within 1000 iterations and needs "
      "more of them than BFGS",
      "quick");
}

/// The smallest ratio of mean losses, JPO over BFGS, of any n >= 8 and seed.
std::optional<double> loss_over_bfgs(const JpoMetrics& metrics) {
  std::optional<double> smallest;
  for (const Index n : sizes_between(metrics, 8)) {
    for (const std::uint64_t seed : metrics.seeds()) {
      const auto* jpo = metrics.ending("jpo", n, seed, false);
      const auto* bfgs = metrics.stage("bfgs", n, seed, "solve");
      if (jpo == nullptr || bfgs == nullptr) continue;
      const double ratio = mean_loss(*jpo) / mean_loss(*bfgs);
      smallest = std::min(smallest.value_or(ratio), ratio);
    }
  }
  return smallest;
}

ClaimResult jpo_needs_refinement(const JpoMetrics& metrics, bool complete) {
  Judge judge;
  if (!complete) {
    judge.missing("a fit with all its iterations");
  } else {
    judge
        .below("highest median L",
               Endings(metrics, "jpo", false, 8).largest(median_loss),
               1e-5)
        .at_least("lowest mean L over BFGS's", loss_over_bfgs(metrics), 1e3)
        .at_least("lowest share solved, refined",
                  Endings(metrics, "jpo", true, 8).smallest(solved),
                  1);
  }
  return std::move(judge).result(
      "R4",
      "For n >= 8 and every seed, JPO has a median L < 1e-5 and a mean L at "
      "least 1000 times that of BFGS; refined, it solves every problem",
      "quick");
}

ClaimResult all_solve_refined(const JpoMetrics& metrics, bool complete) {
  Judge judge;
  if (!complete) {
    judge.missing("fits with all their iterations");
  } else {
    const auto sizes = metrics.sizes();
    for (const char* method : {"supervised", "na"}) {
      judge.at_least(fmt::format("solved, refined: {}", method),
                     metrics.pooled_solved_share(method, sizes, true, kSolved),
                     0.98);
    }
    for (const auto& method : kTrained) {
      judge.below(fmt::format("highest L/n, refined: {}", method),
                  Endings(metrics, method, true).largest(mean_loss),
                  1e-12);
    }
  }
  return std::move(judge).result(
      "R5",
      "Refined, supervised learning and the neural adjoint solve at least 98 % "
      "of the problems, and L/n of every method is below 1e-12 for every n",
      "quick");
}

ClaimResult improvement_is_a_coin_flip(const JpoMetrics& metrics,
                                       bool complete) {
  Judge judge;
  if (!complete) judge.missing("fits with all their iterations");
  const auto worst = [](const StageRecord& s) { return s.loss.maxCoeff(); };
  judge.below("highest L: bfgs",
              Endings(metrics, "bfgs", false).largest(worst),
              kSolved);
  const auto sizes = metrics.sizes();
  for (const auto& method : kTrained) {
    judge.below(fmt::format("highest L, refined: {}", method),
                Endings(metrics, method, true).largest(worst),
                kSolved);
    judge.report(fmt::format("f_N, refined: {}", method),
                 f_of(metrics.mean_shares(method, sizes, true)));
  }
  return std::move(judge).result(
      "R6",
      "f_N against BFGS says nothing here: both losses are rounding errors "
      "(L < 1e-12)",
      "quick",
      false);
}

// ---- figures of the paper that no other experiment has --------------------

constexpr std::array<double, 2> kTarget = {1.4, 0.6};

Series arm_series(std::string label,
                  std::string method,
                  const std::array<double, 4>& x) {
  Series s{
      .label = std::move(label), .method = std::move(method), .markers = true};
  for (const auto& joint : arm_joints(x)) {
    s.x.push_back(joint[0]);
    s.y.push_back(joint[1]);
  }
  return s;
}

/// Fig. 25a: the arm where every method starts, and one that reaches.
Figure task() {
  // The shorter links mirror each other, the long one lies level.
  const double bend = std::acos(kTarget[0] - 1);
  const std::array<double, 4> x = {kTarget[1], bend, 0, bend};
  return {.id = "fig25a",
          .title = "Task: base and joints that bring the tip to a target",
          .source = "Fig. 25a",
          .panels = {{.title = "",
                      .x_label = "horizontal",
                      .y_label = "vertical",
                      .series = {arm_series("start", "bfgs", {0, 0, 0, 0}),
                                 arm_series("a solution", "jpo", x),
                                 {.label = "target",
                                  .method = "truth",
                                  .x = {kTarget[0]},
                                  .y = {kTarget[1]},
                                  .line = false,
                                  .markers = true}}}},
          .columns = 1};
}

/// Fig. 25b: loss and gradient over the first joint angle, through x = 0.
Figure landscape() {
  constexpr Index kPoints = 241;
  const RoboticArm<double> arm;
  Batch<double> x = Batch<double>::Zero(4, kPoints), given(0, kPoints);
  x.row(1).setLinSpaced(-std::numbers::pi, std::numbers::pi);
  Batch<double> y(2, kPoints), target(2, kPoints), y_bar(2, kPoints);
  target.colwise() = Eigen::Vector2d(kTarget[0], kTarget[1]);
  Batch<double> gradient(4, kPoints);
  Vector<double> loss(kPoints);
  Tape tape;
  Workspace work;
  arm.linearize(x, given, y, tape);
  arm.loss(y, target, loss);
  arm.loss_gradient(y, target, y_bar);
  arm.pullback(tape, y_bar, gradient, work);
  const auto panel = [&](const char* label, const auto& values) {
    return Panel{.x_label = "angle 1",
                 .y_label = label,
                 .series = {{.method = "bfgs",
                             .x = {x.row(1).begin(), x.row(1).end()},
                             .y = {values.begin(), values.end()}}}};
  };
  return {
      .id = "fig25b",
      .title = "Loss and gradient over the first joint angle",
      .source = "Fig. 25b",
      .panels = {panel("loss", loss),
                 panel("derivative of the loss", gradient.row(1))},
      .note = fmt::format(
          "Target ({}, {}), all other unknowns 0.", kTarget[0], kTarget[1])};
}

Section report(const Results& results, const Published& published) {
  const JpoReportOptions options{
      .experiment = kName,
      .title = "Robotic arm",
      .paper = "jpo",
      .solved = kSolved,
      .unknowns = {"base", "angle 1", "angle 2", "angle 3"},
      .tensors = {"m1", "b1", "m2", "b2", "m3", "b3", "m4", "b4"},
      .fraction = {"fraction", ""},
      .improvement = {"fig25d", "Fig. 25d (loss after refinement)"},
      .curves = {"fig25c", "Fig. 25c"},
      .trajectories = {"trajectories", ""},
      .weight_change = {"weight_change", ""}};
  Section section = jpo_section(options, results, published);
  // The paper has no table of this experiment.
  for (Table& table : section.tables) table.source.clear();
  // Fig. 25c shows gradient descent too.
  JpoReportOptions with_descent = options;
  with_descent.methods.insert(with_descent.methods.begin(), "gd");
  for (Figure& figure : section.figures) {
    if (figure.id == options.curves.id)
      figure = JpoReport(with_descent, results, published).curves();
  }
  section.figures.insert(section.figures.begin(), {task(), landscape()});
  const JpoMetrics metrics(results, options.experiment);
  const bool full = full_training(results, kName);
  section.claims = {bfgs_solves(metrics),
                    descent_solves(results, metrics, full),
                    jpo_needs_refinement(metrics, full),
                    all_solve_refined(metrics, full),
                    improvement_is_a_coin_flip(metrics, full)};
  return section;
}

const auto kRegistered = register_experiment({
    .name = kName,
    .title = "Robotic arm",
    .source = {.paper = "jpo", .where = "App. D.5, Fig. 25"},
    .problem = problem<RoboticArm>("robotic_arm"),
    .setting = {.predictor = {{Field::observations},
                              nn::mlp({.hidden = {128, 128, 128}})},
                .surrogate = {{Field::unknowns},
                              nn::mlp({.hidden = {128, 128, 128}})},
                .output_scale = 1.0,
                .gtol = 1e-10},
    .profiles =
        {{.name = "smoke",
          .rows =
              {{.methods = {"bfgs"}, .n = {4}, .seeds = {0}},
               {.methods = {"gd"}, .n = {4}, .seeds = {0}, .iterations = 50},
               {.methods = kTrained,
                .n = {4},
                .seeds = {0},
                .iterations = 50}}},
         {.name = "quick",
          .rows = {{.methods = {"bfgs", "gd"}, .n = {8, 64}, .seeds = {0, 1}},
                   {.methods = kTrained,
                    .n = {8, 64},
                    .seeds = {0, 1},
                    .iterations = kFitIterations}}},
         {.name = "paper",
          .rows = {{.methods = {"bfgs", "gd"},
                    .n = {2, 4, 8, 16, 32, 64, 128},
                    .seeds = {0, 1, 2, 3}},
                   {.methods = kTrained,
                    .n = {2, 4, 8, 16, 32, 64, 128},
                    .seeds = {0, 1, 2, 3},
                    .iterations = kFitIterations}}}},
    .methods = jpo_methods({.rate = 1e-3, .iterations = kFitIterations}),
    .report = report,
});

}  // namespace
}  // namespace physinv
