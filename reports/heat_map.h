/// Fields as coloured cells, with their colour bar.
#pragma once

#include "reports/svg.h"
#include "suite/results/report_model.h"

namespace physinv {

/// Fills the box with the field, y upwards, as a PNG inside the drawing, a
/// block of pixels a cell, and draws its bar to the right (74 units). More than
/// 512 cells a side are averaged. Values that cannot be shown stay blank.
void draw_heat_map(
    Svg& svg, const Field2D& field, double x, double y, double w, double h);

}  // namespace physinv
