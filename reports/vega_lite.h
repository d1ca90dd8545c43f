/// Figures as Vega-Lite, version 5: for notebooks, editors and web pages that
/// draw them again.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "reports/palette.h"
#include "suite/results/report_model.h"

namespace physinv {

/// A specification that holds its data: panels side by side, series as lines,
/// points and bands in the colours, dashes and markers of the pages, fields as
/// rectangles, arrows as rules, the legend as the last panel. What cannot be
/// drawn on a log axis is left out.
nlohmann::ordered_json vega_lite(const Figure& figure,
                                 const Palette& report = {});

}  // namespace physinv
