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

/// The panels in a row under their legend, for a narrow place: kCardWidth wide
/// and kCardHeight high, or higher if the names of its rows need it. Has no
/// title, which the page shows as text.
std::string render_card(const Figure& figure, const Palette& report = {});
inline constexpr int kCardWidth = 360, kCardHeight = 270;

}  // namespace physinv
