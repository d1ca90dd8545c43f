/// Colours: those that a case gives its methods, others in order, and a
/// perceptual map for fields. Both are CSS, so that one file suits light and
/// dark pages.
#pragma once

#include <array>
#include <compare>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

/// How a series is drawn: a number of the style sheet's colours, a marker, and
/// one of kDashes patterns.
struct Ink {
  int color = 0;
  Marker marker = Marker::circle;
  int dash = 0;
  auto operator<=>(const Ink&) const = default;
};
inline constexpr int kDashes = 4;

/// Classes of a line: " d" and its like, after a space; empty if it is whole.
std::string dash_css(Ink ink, bool dashed);
/// The same as lengths of ink and gaps; empty if it is whole.
std::vector<double> dash_pattern(Ink ink, bool dashed);
/// A colour of the style sheet on light pages, "#rrggbb".
std::string light_color(int color);

/// The inks of methods. A series with a style has that; others get the colours
/// that looks seldom use, one for each method, in order; then other dashes and
/// markers, so that none is given twice.
class Palette {
 public:
  Palette() = default;
  /// Of a whole report: a method looks the same in every figure, as in most
  /// sections that give it a style.
  explicit Palette(const std::vector<Section>& sections);

  Ink of(const Series& series);
  /// The entry of a figure's legend, and all series like it, get this ink.
  void set(const Series& entry, Ink ink);

 private:
  /// What distinguishes entries of a legend.
  using Entry = std::tuple<std::string, std::string, bool>;
  static Entry entry_of(const Series& series);
  Ink next_free();

  std::map<std::string, Ink> methods_;
  std::map<Entry, Ink> entries_;
  std::map<std::string, Ink> unnamed_;  ///< of the first entry of a method
  int others_ = 0;
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
