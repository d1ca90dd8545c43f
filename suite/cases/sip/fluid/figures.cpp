#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "problems/marker_flow/marker_flow.h"
#include "suite/cases/sip/fluid/fluid.h"
#include "suite/cases/sip/fluid/metrics.h"
#include "suite/core/any_problem.h"
#include "suite/evidence/field_panel.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"

namespace physinv::fluid_case {
namespace {

const std::vector<MethodLine> kLines = {
    {"sip", "SIP", Hue::orange},
    {"adam", "Adam", Hue::purple},
    {"sip-b16", "SIP, batch 16", Hue::orange},
    {"adam-b16", "Adam, batch 16", Hue::purple},
    {"sip-b4", "SIP, batch 4", Hue::orange},
    {"adam-b4", "Adam, batch 4", Hue::purple}};

constexpr Index kPlane = kCells * kCells;

constexpr FieldLayout kLayout{kCells, kCells, kCells, 1};

/// The marker after so many steps.
Vector<double> carried(const Vector<double>& x,
                       const Vector<double>& marker,
                       Index steps) {
  MarkerFlowOptions o{.cells = kCells};
  o.end_time *= double(steps) / double(o.steps);
  o.steps = steps;
  Batch<double> y(kPlane, 1);
  Workspace work;
  AnyProblem<double>(problems::marker_flow(o)).forward(x, marker, y, work);
  return y;
}

/// The first test example of the first seed by each method, truth first.
struct Said {
  std::string who;
  Vector<double> x, marker;
};
std::vector<Said> said(const Evidence& e) {
  std::vector<Said> all;
  for (const MethodLine& line : one_of_each(e, kLines)) {
    const auto answer = answer_of(e, line.method);
    if (!answer || answer->x.size() != 2 * kPlane) continue;
    if (all.empty()) all.push_back({"truth", answer->truth, answer->given});
    all.push_back({line.label, answer->x, answer->given});
  }
  return all;
}

/// v0, and where it takes the marker: at t = 0, 1 and 2.
std::vector<Panel> frames(const Said& said) {
  const auto& [who, x, marker] = said;
  std::vector<Panel> row = {
      flow_panel(who + ", v0", kLayout, x.head(kPlane), x.tail(kPlane), 4)};
  for (Index step = 0; step <= 8; step += 4)
    row.push_back(
        field_panel(fmt::format("{}, t = {}", who, 0.25 * double(step)),
                    kLayout,
                    step == 0 ? marker : carried(x, marker, step)));
  share_scale(std::span(row).subspan(1));
  return row;
}

/// A row for the truth and for each method.
Figure pictures(const std::vector<Said>& all) {
  Figure figure{.id = "fig14",
                .title = "Velocities found, and where they take the marker",
                .where = "Fig. 14",
                .columns = 4,
                .note =
                    "First test example, v0 and the marker's density at "
                    "times 0 to 2. Arrows: every fourth cell.",
                .picture = true};
  for (const Said& one : all)
    for (Panel& panel : frames(one)) figure.panels.push_back(std::move(panel));
  return figure;
}

/// The same, step by step.
Figure film(const std::vector<Said>& all) {
  Figure figure{.id = "film",
                .title = "The marker on its way",
                .where = "Fig. 14",
                .columns = int(std::min<std::size_t>(all.size(), 4)),
                .note = "First test example, after 0 to 8 steps.",
                .moment = int(all.size())};
  for (Index step = 0; step <= 8; ++step)
    for (const auto& [who, x, marker] : all)
      figure.panels.push_back(
          field_panel(who + ", step " + std::to_string(step),
                      kLayout,
                      step == 0 ? marker : carried(x, marker, step)));
  share_scale(figure.panels);
  return figure;
}

Section report(const Evidence& e) {
  Section section{.tables = {loss_table(e, kLines)},
                  .method_titles = titles_of(kLines)};
  LearningCurves curves(e, section);
  curves.metric(
      kLines, kError, "|x - x*|", "errors", "Errors of v0", "Fig. 14");
  curves.metric(
      kLines, kVortex, "|s - s*|", "vortex", "Errors of the vortex", "");
  curves.losses(kLines, "losses", "Losses of the marker", "");
  curves.add(update_times(e, kLines, "Fig. 15"));
  if (const auto all = said(e); !all.empty()) {
    section.figures.push_back(pictures(all));
    section.figures.push_back(film(all));
  }
  return section;
}

}  // namespace

void add_reports(Registry& r) {
  for (const Variant& v : {kCode, kTimed}) r.add_report(v.experiment, report);
}

}  // namespace physinv::fluid_case
