/// Pieces of the HTML report. All text arguments are plain and are escaped.
#pragma once

#include <string>
#include <string_view>

#include "suite/results/report_model.h"

namespace physinv {

extern const std::string_view kPageCss, kPageJs;

/// Text as HTML.
std::string html(std::string_view text);

/// "Fig. 11 · Title" as a link to its own place.
std::string caption_html(const std::string& id,
                         std::string_view source,
                         std::string_view title);

/// Our numbers and, where there are some, the paper's side by side; spreads
/// are columns of their own, so that digits stand below each other. A table
/// that is wide and flat is turned.
std::string table_html(const Table& table, const std::string& id);

/// Panels as in the SVG file, each a drawing of its own so that they flow on
/// narrow screens; title, legend and note are HTML.
std::string figure_html(const Figure& figure, const std::string& id);

}  // namespace physinv
