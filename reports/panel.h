/// One panel of a figure: axes, curves, field.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "reports/axis.h"
#include "reports/palette.h"
#include "reports/svg.h"
#include "suite/results/report_model.h"

namespace physinv {

struct Rect {
  double x = 0, y = 0, w = 0, h = 0;
};

/// Does the panel draw a point of this series?
bool shows(const Panel& panel, const Series& series);
/// Is there anything to draw? Dashed lines of reference at one height do not
/// count where no series has a point.
bool has_points(const Panel& panel);
/// The one value at which all of several points are; bands are none.
std::optional<double> constant_of(const Panel& panel);

/// Height over width of a place (`Panel::space`): of its field, whose cells are
/// squares, or of its limits.
double slope_of(const Panel& panel);

class PanelPlot {
 public:
  /// `id` is unique in the document: it names the clip path.
  PanelPlot(const Panel& panel, std::string id, Palette& palette);

  /// Marks each series with its place in the legend (class k<i>, -1 for none)
  /// and the panel with its axes, for the script of a page.
  void set_keys(std::vector<int> keys) { keys_ = std::move(keys); }

  /// As usual, or what the names of its rows or the shape of its place need.
  double height(double width, double usual) const;

  /// Draws into `cell`, labels included.
  void draw(Svg& svg, const Rect& cell) const;

 private:
  void fit_axes();
  Rect box_in(const Rect& cell) const;
  Rect place_in(const Rect& cell) const;
  /// Ticks, their values being shares of the axis.
  std::vector<Tick> x_marks(int wanted) const;
  std::vector<Tick> y_marks(int wanted) const;
  double turned_names(double width) const;
  void furniture(Svg& svg, const Rect& box, const Rect& cell) const;
  void ticks(Svg& svg, const Rect& box, const Rect& cell) const;
  void curves(Svg& svg, const Rect& box) const;
  void arrows(Svg& svg, const Rect& box, const Arrows& of) const;
  void band(Svg& svg, const Rect& box, const Series& s, int color) const;
  void error_bars(Svg& svg, const Rect& box, const Series& s, int color) const;
  void markers(Svg& svg, const Rect& box, const Series& s, Ink ink) const;
  // Moved aside by a few units, so that error bars of one x stay apart.
  Rect dodged(const Rect& box, const Series& series) const;
  void open_panel(Svg& svg, const Rect& box) const;
  void open_series(Svg& svg, const Rect& box, const Series& series) const;
  void close_series(Svg& svg) const;
  std::string line_path(const Rect& box, const Series& s) const;
  double px(const Rect& box, double value) const;
  double py(const Rect& box, double value) const;

  const Panel& panel_;
  std::string id_;
  Palette& palette_;
  Axis x_, y_;
  std::vector<int> keys_;  // empty: no marks
  bool run_ = false;
};

/// A marker around a point, `css` its colour; hollow if the line is dashed.
void draw_marker(
    Svg& svg, Marker marker, double x, double y, int color, bool hollow);

}  // namespace physinv
