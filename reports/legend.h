/// What the series of a figure are called: one entry per style, shared by all
/// panels.
#pragma once

#include <compare>
#include <string>
#include <vector>

#include "reports/palette.h"
#include "reports/svg.h"
#include "suite/results/report_model.h"

namespace physinv {

/// One series for each label, method and stroke that is drawn, in order.
std::vector<const Series*> legend_of(const Figure& figure);

/// What has labels and is not drawn: "not run: JPO; no finite number: Adam".
/// Empty if there is nothing, or nothing else.
std::string undrawn_text(const Figure& figure);

/// Where a series is in the legend, -1 if nowhere. One without a label goes
/// with the first of its method.
int legend_index(const std::vector<const Series*>& legend,
                 const Series& series);

/// What distinguishes an entry of a legend: its drawn line and markers.
struct DrawnStyle {
  int color = 0, marker = -1, pattern = -1;  ///< -1: none
  auto operator<=>(const DrawnStyle&) const = default;
};
DrawnStyle drawn_style(const Series& series, Ink ink);

/// The inks of a figure: those of the report, unless two entries of its legend
/// would look alike; then the later one gets the next dash, marker or colour
/// that is free.
Palette palette_of(const Figure& figure, const Palette& report = {});

/// A sample of the line, 28 units wide, and of the marker.
void draw_sample(
    Svg& svg, const Series& series, Ink ink, double left, double middle);

}  // namespace physinv
