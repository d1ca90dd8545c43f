/// What the series of a figure are called: one entry per look, shared by all
/// panels.
#pragma once

#include <vector>

#include "reports/palette.h"
#include "reports/svg.h"
#include "suite/results/report_model.h"

namespace physinv {

/// One series for each label, method and stroke there is, in order.
std::vector<const Series*> legend_of(const Figure& figure);

/// Where a series is in the legend, -1 if nowhere. One without a label goes
/// with the first of its method.
int legend_index(const std::vector<const Series*>& legend,
                 const Series& series);

/// Numbers the methods in the order of the legend, not of drawing: panels may
/// show different looks under one name.
Palette palette_of(const Figure& figure);

/// A sample of the line, 28 units wide, and of the marker.
void draw_sample(
    Svg& svg, const Series& series, Ink ink, double left, double middle);

}  // namespace physinv
