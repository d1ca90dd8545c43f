/// Draws the figures of the report model.
#pragma once

#include <string>

#include "reports/palette.h"
#include "suite/results/report_model.h"

namespace physinv {

/// One SVG document of all panels in a grid under a common legend. Light and
/// dark follow the reader's system; the bytes depend on the figure only.
/// Points that are not finite, or not positive on a log axis, leave a gap; a
/// panel without points reads "not run". Few points with `lo`, `hi` and
/// markers get error bars, all others a band.
/// Fields are drawn as if their grid were even along the (log) axes.
/// Methods have the inks of `report`.
std::string render_svg(const Figure& figure, const Palette& report = {});

}  // namespace physinv
