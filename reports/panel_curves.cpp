#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/marks.h"
#include "reports/panel.h"
#include "suite/core/math.h"

namespace physinv {
namespace {

constexpr double kDodge = 3.5;  // between error bars of one x
constexpr std::size_t kManyMarkers = 60;

}  // namespace

void draw_marker(
    Svg& svg, Marker marker, double x, double y, int color, bool hollow) {
  const std::string css = fmt::format("{}{}", hollow ? "o s" : "m f", color);
  const auto polygon =
      [&](std::initializer_list<std::pair<double, double>> way) {
        std::string d;
        for (const auto& [dx, dy] : way) {
          d += path_step(d.empty() ? 'M' : 'L', x + dx, y + dy);
        }
        svg.path(css, d + "Z");
      };
  switch (marker) {
    case Marker::circle:
      svg.leaf("circle",
               {{"class", css},
                {"cx", svg_number(x)},
                {"cy", svg_number(y)},
                {"r", "4"}});
      break;
    case Marker::square:
      svg.rect(css, x - 3.6, y - 3.6, 7.2, 7.2);
      break;
    case Marker::triangle:
      polygon({{0, -4.8}, {4.6, 3.4}, {-4.6, 3.4}});
      break;
    case Marker::diamond:
      polygon({{0, -5}, {4.6, 0}, {0, 5}, {-4.6, 0}});
      break;
    case Marker::down:
      polygon({{0, 4.8}, {4.6, -3.4}, {-4.6, -3.4}});
      break;
    case Marker::cross:
      svg.path(fmt::format("x s{}", color),
               path_step('M', x - 4.5, y - 4.5) +
                   path_step('L', x + 4.5, y + 4.5) +
                   path_step('M', x - 4.5, y + 4.5) +
                   path_step('L', x + 4.5, y - 4.5));
      break;
  }
}

void PanelPlot::curves(Svg& svg, const Rect& box) const {
  svg.open("g", {{"clip-path", "url(#" + id_ + ")"}});
  for (const Series& s : panel_.series) {
    if (has_spread(s) && !has_error_bars(s)) {
      open_series(svg, box, s);
      band(svg, box, s, palette_.of(s).color);
      close_series(svg);
    }
  }
  for (const Series& s : panel_.series) {
    if (!s.line) continue;
    const std::string d = line_path(dodged(box, s), s);
    const Ink ink = palette_.of(s);
    open_series(svg, box, s);
    if (panel_.field) svg.path("halo", d);
    svg.path(fmt::format("l s{}{}", ink.color, dash_css(ink, s.dashed)), d);
    close_series(svg);
  }
  svg.close();
  for (const Series& s : panel_.series) {
    if (!has_error_bars(s) && !s.markers && s.line) continue;
    const Ink ink = palette_.of(s);
    open_series(svg, box, s);
    if (has_error_bars(s)) error_bars(svg, dodged(box, s), s, ink.color);
    if (s.markers || !s.line) markers(svg, dodged(box, s), s, ink);
    close_series(svg);
  }
}

/// Shafts with two strokes as their heads, in one path; dots where nothing
/// moves.
void PanelPlot::arrows(Svg& svg, const Rect& box, const Arrows& of) const {
  double longest = 0;
  for (std::size_t i = 0; i < of.u.size(); ++i)
    longest = std::max(longest, math::hypot(of.u[i], of.v[i]));
  const double unit =
      longest > 0 && std::isfinite(longest)
          ? std::abs(px(box, x_.lo() + of.length) - px(box, x_.lo())) / longest
          : 0;
  std::string d;
  for (std::size_t i = 0; i < of.u.size(); ++i) {
    const double x = px(box, of.x[i]), y = py(box, of.y[i]);
    const double u = unit * of.u[i], v = -unit * of.v[i];
    if (!std::isfinite(u + v + x + y)) continue;
    d += fmt::format("M{} {}l{} {}",
                     svg_number(x - u / 2),
                     svg_number(y - v / 2),
                     svg_number(u),
                     svg_number(v));
    for (const double side : {1.0, -1.0})
      d += fmt::format("M{} {}l{} {}",
                       svg_number(x + u / 2),
                       svg_number(y + v / 2),
                       svg_number(-0.3 * u + side * 0.15 * v),
                       svg_number(-0.3 * v - side * 0.15 * u));
  }
  svg.path("arrow", d);
}

void PanelPlot::open_series(Svg& svg,
                            const Rect& box,
                            const Series& series) const {
  if (keys_.empty()) return;
  const int key =
      keys_[static_cast<std::size_t>(&series - panel_.series.data())];
  const double aside = dodged(box, series).x - box.x;
  svg.open("g",
           {{"class", key < 0 ? "k" : fmt::format("k k{}", key)},
            {"data-dx", aside == 0 ? "" : svg_number(aside)}});
}

void PanelPlot::close_series(Svg& svg) const {
  if (!keys_.empty()) svg.close();
}

Rect PanelPlot::dodged(const Rect& box, const Series& series) const {
  if (!has_error_bars(series)) return box;
  double before = 0, all = -1;
  for (const Series& s : panel_.series) {
    if (!has_error_bars(s)) continue;
    before += &s < &series;
    all += 1;
  }
  Rect moved = box;
  moved.x += kDodge * (before - all / 2);
  return moved;
}

std::string PanelPlot::line_path(const Rect& box, const Series& s) const {
  std::string d, last;
  bool pen_down = false;
  for (std::size_t i = 0; i < points(s); ++i) {
    if (!x_.shows(s.x[i]) || !y_.shows(s.y[i])) {
      pen_down = false;
      continue;
    }
    std::string here =
        path_step(pen_down ? 'L' : 'M', px(box, s.x[i]), py(box, s.y[i]));
    if (here == last) continue;
    d += here;
    last = std::move(here);
    pen_down = true;
  }
  return d;
}

void PanelPlot::band(Svg& svg,
                     const Rect& box,
                     const Series& s,
                     int color) const {
  std::string upper, lower;
  const auto flush = [&] {
    if (!upper.empty()) {
      upper.front() = 'M';
      svg.path(fmt::format("b f{}", color), upper + lower + "Z");
    }
    upper.clear();
    lower.clear();
  };
  for (std::size_t i = 0; i < points(s); ++i) {
    const bool drawn = x_.shows(s.x[i]) && y_.shows(s.y[i]) &&
                       y_.shows(s.hi[i]) && std::isfinite(s.lo[i]);
    if (!drawn) {
      flush();
      continue;
    }
    const double lo = y_.shows(s.lo[i]) ? s.lo[i] : y_.lo();
    const double x = px(box, s.x[i]);
    upper += path_step('L', x, py(box, s.hi[i]));
    lower.insert(0, path_step('L', x, py(box, lo)));
  }
  flush();
}

void PanelPlot::error_bars(Svg& svg,
                           const Rect& box,
                           const Series& s,
                           int color) const {
  std::string d;
  for (std::size_t i = 0; i < points(s); ++i) {
    if (!x_.shows(s.x[i]) || !y_.shows(s.y[i]) || !y_.shows(s.hi[i]) ||
        !std::isfinite(s.lo[i]) || !(s.hi[i] > s.lo[i])) {
      continue;
    }
    const double lo = y_.shows(s.lo[i]) ? std::max(s.lo[i], y_.lo()) : y_.lo();
    const double x = px(box, s.x[i]);
    const double a = py(box, lo), b = py(box, std::min(s.hi[i], y_.hi()));
    d += path_step('M', x, a) + path_step('L', x, b);
    if (s.lo[i] >= y_.lo()) d += path_step('M', x - 3, a) + "h6";
    d += path_step('M', x - 3, b) + "h6";
  }
  svg.path(fmt::format("e s{}", color), d);
}

void PanelPlot::markers(Svg& svg,
                        const Rect& box,
                        const Series& s,
                        Ink ink) const {
  const std::size_t stride = 1 + points(s) / kManyMarkers;
  for (std::size_t i = 0; i < points(s); i += stride) {
    if (!x_.shows(s.x[i]) || !y_.shows(s.y[i])) continue;
    const double u = x_.place(s.x[i]), v = y_.place(s.y[i]);
    if (u < 0 || u > 1 || v < 0 || v > 1) continue;
    draw_marker(
        svg, ink.marker, px(box, s.x[i]), py(box, s.y[i]), ink.color, s.dashed);
  }
}

}  // namespace physinv
