/// Colours: one per method as in the papers, and a perceptual map for fields.
/// Both are CSS, so that one file suits light and dark pages.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace physinv {

/// Numbers the methods of one figure. Known methods (bfgs blue, jpo orange,
/// supervised green, na red, gd purple, truth in the colour of text) keep
/// their number everywhere; others get the next free colour.
class Palette {
 public:
  int index(std::string_view method);

 private:
  std::vector<std::string> others_;
};

enum class Marker { circle, square, triangle, diamond, down, cross };
Marker marker_of(int index);

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
