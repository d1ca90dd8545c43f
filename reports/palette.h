/// Colours: those that a case gives its methods, others in order, and a
/// perceptual map for fields. Both are CSS, so that one file suits light and
/// dark pages.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

/// How a series is drawn: a number of the style sheet's colours, and a marker.
struct Ink {
  int color = 0;
  Marker marker = Marker::circle;
};

/// The inks of one figure. A series with a look has that; others get the
/// colours that looks seldom use, one for each method, in order.
class Palette {
 public:
  Ink of(const Series& series);

 private:
  std::vector<std::string> others_;
};

/// The style sheet of a figure: classes s<i> (stroke), f<i> (fill), and the
/// furniture (bg, grid, frame, tick, label, title, note, halo).
std::string style_sheet();

/// The same for a page of many figures, its colours in custom properties: c<i>
/// of methods, and bg, grid, frame, ink, soft, yes, no of the page. Follows
/// the reader's system unless data-theme of the root says light or dark;
/// print is light.
std::string page_style_sheet();

inline constexpr int kFieldColors = 32;
/// Viridis in 32 steps, dark blue to yellow: "#440154".
const std::array<std::string, kFieldColors>& field_colors();

}  // namespace physinv
