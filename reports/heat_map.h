/// Fields as coloured cells, with their colour bar.
#pragma once

#include "reports/svg.h"
#include "suite/results/report_model.h"

namespace physinv {

/// Fills the box with the field, y upwards, and draws its bar to the right
/// (74 units). Cells of one colour in a row become one stroke, so that a file
/// stays below about 300 kB. Values that cannot be shown stay blank.
void draw_heat_map(
    Svg& svg, const Field2D& field, double x, double y, double w, double h);

}  // namespace physinv
