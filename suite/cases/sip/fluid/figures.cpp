#include <string>
#include <utility>
#include <vector>

#include "problems/marker_flow/marker_flow.h"
#include "suite/cases/sip/fluid/fluid.h"
#include "suite/cases/sip/fluid/metrics.h"
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

/// Two by two cells as one, x to the right.
Panel picture(std::string title, const Vector<double>& f) {
  Panel panel{.title = std::move(title), .field = Field2D{}};
  for (Index a = 1; a < kCells; a += 2) {
    panel.field->x.push_back(double(a));
    panel.field->y.push_back(double(a));
  }
  for (Index j = 0; j < kCells; j += 2)
    for (Index i = 0; i < kCells; i += 2) {
      const Index at = i * kCells + j;
      panel.field->values.push_back(
          (f(at) + f(at + 1) + f(at + kCells) + f(at + kCells + 1)) / 4);
    }
  return panel;
}

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

/// A row of Fig. 14: v0, and where it takes the marker.
void add_row(const std::string& of,
             const Vector<double>& x,
             const Vector<double>& marker,
             Figure& figure) {
  if (x.size() != 2 * kPlane) return;
  const auto add = [&](const char* what, const Vector<double>& f) {
    figure.panels.push_back(picture(of + ", " + what, f));
  };
  add("v0, x", x.head(kPlane)), add("v0, y", x.tail(kPlane));
  add("marker at 1", carried(x, marker, 4));
  add("marker at 2", carried(x, marker, 8));
}

/// The first test example of the first seed.
Figure pictures(const Variant& variant, const Results& results) {
  Figure figure{.id = "fig14",
                .title = "Velocities found, and where they take the marker",
                .source = "Fig. 14",
                .columns = 4,
                .note = "First test example. Four cells are one here."};
  for (const MethodLine& line : kLines) {
    const auto answer = first_answer(results, variant.experiment, line.method);
    if (!answer) continue;
    if (figure.panels.empty())
      add_row("truth", answer->truth, answer->given, figure);
    add_row(line.label, answer->x, answer->given, figure);
  }
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
  if (Figure fields = pictures(variant, results); !fields.panels.empty())
    section.figures.push_back(std::move(fields));
  return section;
}

const bool kReports = [] {
  bool all = true;
  for (const Variant& v : {kCode, kTimed})
    all = register_report(v.experiment,
                          [v](const Results& r, const Published&) {
                            return section_of(v, r);
                          }) &&
          all;
  return all;
}();

}  // namespace
}  // namespace physinv::fluid_case
