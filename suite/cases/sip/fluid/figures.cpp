#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "problems/marker_flow/marker_flow.h"
#include "suite/cases/sip/fluid/fluid.h"
#include "suite/cases/sip/fluid/metrics.h"
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
  MarkerFlow<double>(o).forward(x, marker, y, work);
  return y;
}

/// First test example of the first seed: who says what, truth first.
struct Said {
  std::string who;
  Vector<double> x, marker;
};
std::vector<Said> said(const Variant& variant, const Results& results) {
  std::vector<Said> all;
  for (const MethodLine& line : kLines) {
    const auto answer = first_answer(results, variant.experiment, line.method);
    if (!answer || answer->x.size() != 2 * kPlane) continue;
    if (all.empty()) all.push_back({"truth", answer->truth, answer->given});
    all.push_back({line.label, answer->x, answer->given});
  }
  return all;
}

/// A row for each: v0, and where it takes the marker.
Figure pictures(const std::vector<Said>& all) {
  Figure figure{.id = "fig14",
                .title = "Velocities found, and where they take the marker",
                .source = "Fig. 14",
                .columns = 3,
                .note = "First test example. Arrows: every fourth cell."};
  for (const auto& [who, x, marker] : all) {
    figure.panels.push_back(
        flow_panel(who + ", v0", kLayout, x.head(kPlane), x.tail(kPlane), 4));
    for (const Index time : {1, 2})
      figure.panels.push_back(
          field_panel(who + ", marker at " + std::to_string(time),
                      kLayout,
                      carried(x, marker, 4 * time)));
  }
  return figure;
}

/// The same, step by step.
Figure film(const std::vector<Said>& all) {
  Figure figure{.id = "film",
                .title = "The marker on its way",
                .source = "Fig. 14",
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

Section section_of(const Variant& variant, const Results& results) {
  Section section{.experiment = variant.experiment,
                  .tables = {loss_table(results, variant.experiment, kLines)}};
  LearningCurves curves(results, section);
  curves.metric(
      kLines, kError, "|x - x*|", "errors", "Errors of v0", "Fig. 14");
  curves.metric(
      kLines, kVortex, "|s - s*|", "vortex", "Errors of the vortex", "");
  curves.losses(kLines, "losses", "Losses of the marker", "");
  curves.add(update_times(results, variant.experiment, kLines, "Fig. 15"));
  if (const auto all = said(variant, results); !all.empty()) {
    section.figures.push_back(pictures(all));
    section.figures.push_back(film(all));
  }
  return section;
}

}  // namespace

void add_reports(Registry& r) {
  for (const Variant& v : {kCode, kTimed})
    r.add_report(v.experiment, [v](const Results& results, const Published&) {
      return section_of(v, results);
    });
}

}  // namespace physinv::fluid_case
