// Poses and Fig. 25 of the JPO paper, in addition to what all its experiments
// show.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "problems/robotic_arm/robotic_arm.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/core/math.h"
#include "suite/evidence/landscape.h"
#include "suite/evidence/picture.h"
#include "suite/evidence/series.h"
#include "suite/harness/registry.h"

namespace physinv::jpo::robotic_arm {
namespace {

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
  const double bend = math::acos(kTarget[0] - 1);
  const std::array<double, 4> x = {kTarget[1], bend, 0, bend};
  return {
      .id = "fig25a",
      .title = "Task: base and joints that bring the tip to a target",
      .where = "Fig. 25a",
      .panels = {{.title = "",
                  .x_label = "horizontal",
                  .y_label = "vertical",
                  .series = {arm_series("start", "bfgs", {0, 0, 0, 0}),
                             arm_series("a solution", "jpo", x),
                             mark("target", "truth", kTarget[0], kTarget[1])}}},
      .columns = 1};
}

/// Fig. 25b: loss and gradient over the first joint angle, through x = 0.
Figure landscape() {
  Batch<double> x = Batch<double>::Zero(4, 241);
  x.row(1).setLinSpaced(-std::numbers::pi, std::numbers::pi);
  return {
      .id = "fig25b",
      .title = "Loss and gradient over the first joint angle",
      .where = "Fig. 25b",
      .panels = loss_and_derivative(
          *problems::robotic_arm().make<double>(),
          {Eigen::Vector2d(kTarget[0], kTarget[1])},
          x,
          {.label = "angle 1", .at = x.row(1), .unknown = 1},
          "bfgs"),
      .note = fmt::format(
          "Target ({}, {}), all other unknowns 0.", kTarget[0], kTarget[1])};
}

/// The arm on its rail; the title says how far the tip is from the target.
Panel pose(const FoundBy& found, const Pictured& problem) {
  const auto joints =
      arm_joints({found.x(0), found.x(1), found.x(2), found.x(3)});
  const double miss = math::hypot(joints.back()[0] - problem.y(0),
                                  joints.back()[1] - problem.y(1));
  Panel panel{.title = fmt::format("{}: {:.2g} off", found.who, miss),
              .y_min = -1,
              .y_max = 1,
              .x_min = -0.3,
              .x_max = 2.2,
              .space = true};
  if (miss < 1e-3) panel.title = found.who + ": on target";
  panel.series.push_back({.label = "rail",
                          .method = "rail",
                          .x = {0, 0},
                          .y = {-1, 1},
                          .style = PlotStyle{Hue::grey, Marker::circle}});
  Series arm{.label = "arm",
             .method = "arm",
             .markers = true,
             .style = PlotStyle{Hue::blue, Marker::circle}};
  for (const auto& joint : joints) {
    arm.x.push_back(few_digits(joint[0]));
    arm.y.push_back(few_digits(joint[1]));
  }
  panel.series.push_back(std::move(arm));
  panel.series.push_back(mark("target",
                              "target of the tip",
                              few_digits(problem.y(0)),
                              few_digits(problem.y(1)),
                              PlotStyle{Hue::ink, Marker::cross}));
  return panel;
}

PictureOptions poses() {
  return {.title =
              "The arm: a pose that reaches, the first guess, and the "
              "pose that each method finds",
          .note =
              "The base slides on the rail; the title says how far the "
              "tip is from the target, which many poses reach.",
          .draw = pose};
}

Section report(const Evidence& e) {
  const JpoReportOptions options{
      .solved = 1e-12,
      .unknowns = {"base", "angle 1", "angle 2", "angle 3"},
      .fraction = {"fraction", ""},
      .improvement = {"fig25d", "Fig. 25d (loss after refinement)"},
      .curves = {"fig25c", "Fig. 25c"},
      .trajectories = {"trajectories", ""},
      .weight_change = {"weight_change", ""},
      .picture = poses()};
  Section section = jpo_section(options, e);
  // The paper has no table of this experiment.
  for (Table& table : section.tables) table.where.clear();
  // Fig. 25c shows gradient descent too.
  JpoReportOptions with_descent = options;
  with_descent.methods.insert(with_descent.methods.begin(), "gd");
  for (Figure& figure : section.figures) {
    if (figure.id == options.curves.id)
      figure = JpoReport(with_descent, e).curves();
  }
  section.figures.insert(section.figures.begin(), {task(), landscape()});
  return section;
}

}  // namespace

void add_reports(Registry& r) { r.add_report("jpo/robotic-arm", report); }

}  // namespace physinv::jpo::robotic_arm
