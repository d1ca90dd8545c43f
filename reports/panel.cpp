#include "reports/panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/heat_map.h"
#include "reports/text.h"

namespace physinv {
namespace {

constexpr double kTickWidth = 6.3;  // of a character of the tick font
constexpr double kDodge = 3.5;      // between error bars of one x
constexpr std::size_t kFewPoints = 12, kManyMarkers = 60;

bool has_spread(const Series& s) {
  return !s.y.empty() && s.lo.size() == s.y.size() && s.hi.size() == s.y.size();
}

bool has_error_bars(const Series& s) {
  return has_spread(s) && s.y.size() <= kFewPoints && (s.markers || !s.line);
}

std::size_t points(const Series& s) { return std::min(s.x.size(), s.y.size()); }

// Names of rows or columns stand at the middle of their cells.
std::vector<Tick> named(const std::vector<std::string>& names) {
  std::vector<Tick> ticks;
  for (std::size_t i = 0; i < names.size(); ++i)
    ticks.push_back(
        {(static_cast<double>(i) + 0.5) / static_cast<double>(names.size()),
         names[i]});
  return ticks;
}

// A step of a path: M moves there, L draws a line.
std::string go(char verb, double x, double y) {
  return fmt::format("{}{} {}", verb, svg_number(x), svg_number(y));
}

}  // namespace

void draw_marker(
    Svg& svg, Marker marker, double x, double y, int color, bool hollow) {
  const std::string css = fmt::format("{}{}", hollow ? "o s" : "m f", color);
  const auto polygon =
      [&](std::initializer_list<std::pair<double, double>> way) {
        std::string d;
        for (const auto& [dx, dy] : way) {
          d += go(d.empty() ? 'M' : 'L', x + dx, y + dy);
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
               go('M', x - 4.5, y - 4.5) + go('L', x + 4.5, y + 4.5) +
                   go('M', x - 4.5, y + 4.5) + go('L', x + 4.5, y - 4.5));
      break;
  }
}

bool has_points(const Panel& panel) {
  if (panel.field && !panel.field->values.empty()) return true;
  const Axis x(panel.x_log), y(panel.y_log);
  return std::any_of(
      panel.series.begin(), panel.series.end(), [&](const Series& s) {
        for (std::size_t i = 0; i < points(s); ++i)
          if (x.shows(s.x[i]) && y.shows(s.y[i])) return true;
        return false;
      });
}

PanelPlot::PanelPlot(const Panel& panel, std::string id, Palette& palette)
    : panel_(panel),
      id_(std::move(id)),
      palette_(palette),
      x_(panel.x_log),
      y_(panel.y_log) {
  fit_axes();
}

void PanelPlot::fit_axes() {
  Axis data_y(panel_.y_log);
  for (const Series& s : panel_.series) {
    for (std::size_t i = 0; i < points(s); ++i) {
      if (!x_.shows(s.x[i]) || !y_.shows(s.y[i])) continue;
      run_ = true;
      x_.include(s.x[i]);
      y_.include(s.y[i]);
      data_y.include(s.y[i]);
    }
  }
  for (const Series& s : panel_.series) {
    if (!has_spread(s)) continue;
    for (std::size_t i = 0; i < points(s); ++i) {
      if (!x_.shows(s.x[i]) || !y_.shows(s.y[i])) continue;
      // Mean minus deviation may come close to 0: no reason for more decades.
      if (!panel_.y_log || s.lo[i] > 0.3 * data_y.lo()) y_.include(s.lo[i]);
      y_.include(s.hi[i]);
    }
  }
  if (panel_.field && !panel_.field->values.empty()) {
    run_ = true;
    for (const double x : panel_.field->x) x_.include(x);
    for (const double y : panel_.field->y) y_.include(y);
    x_.finish_tight();
    y_.finish_tight();
  } else {
    x_.finish();
    y_.finish(panel_.y_min, panel_.y_max);
  }
}

double PanelPlot::px(const Rect& box, double value) const {
  return box.x + box.w * x_.place(value);
}

double PanelPlot::py(const Rect& box, double value) const {
  return box.y + box.h * (1 - y_.place(value));
}

void PanelPlot::draw(Svg& svg, const Rect& cell) const {
  std::size_t tick_width = 2;
  const int y_ticks = std::max(2, static_cast<int>(cell.h / 50));
  for (const Tick& t : y_marks(y_ticks)) {
    tick_width = std::max(tick_width, display_width(t.label));
  }
  const double left = (panel_.y_label.empty() ? 10 : 28) +
                      kTickWidth * static_cast<double>(tick_width);
  const double right = panel_.field ? 74 : 14;
  const double top = panel_.title.empty() ? 10 : 28;
  const bool names = panel_.field && !panel_.field->x_names.empty();
  const double bottom = panel_.x_label.empty() ? names ? 40 : 26 : 44;
  const Rect box{cell.x + left,
                 cell.y + top,
                 cell.w - left - right,
                 cell.h - top - bottom};
  open_panel(svg, box);
  furniture(svg, box, cell);
  svg.open("clipPath", {{"id", id_}});
  svg.rect("", box.x, box.y, box.w, box.h);
  svg.close();
  if (panel_.field && !panel_.field->values.empty()) {
    draw_heat_map(svg, *panel_.field, box.x, box.y, box.w, box.h);
  }
  if (panel_.arrows) arrows(svg, box, *panel_.arrows);
  curves(svg, box);
  svg.rect("frame", box.x, box.y, box.w, box.h);
  if (!run_) {
    svg.text(
        "label", box.x + box.w / 2, box.y + box.h / 2 + 4, "not run", "middle");
  }
  svg.close();
}

std::vector<Tick> PanelPlot::x_marks(int wanted) const {
  if (panel_.field && !panel_.field->x_names.empty())
    return named(panel_.field->x_names);
  auto ticks = x_.ticks(wanted);
  for (Tick& t : ticks) t.value = x_.place(t.value);
  return ticks;
}

std::vector<Tick> PanelPlot::y_marks(int wanted) const {
  if (panel_.field && !panel_.field->y_names.empty())
    return named(panel_.field->y_names);
  auto ticks = y_.ticks(wanted);
  for (Tick& t : ticks) t.value = y_.place(t.value);
  return ticks;
}

void PanelPlot::furniture(Svg& svg, const Rect& box, const Rect& cell) const {
  if (!panel_.title.empty()) {
    svg.text("head", box.x + box.w / 2, box.y - 10, panel_.title, "middle");
  }
  if (!panel_.x_label.empty()) {
    svg.text("label",
             box.x + box.w / 2,
             box.y + box.h + 36,
             panel_.x_label,
             "middle");
  }
  if (!panel_.y_label.empty()) {
    svg.text("label",
             cell.x + 12,
             box.y + box.h / 2,
             panel_.y_label,
             "middle",
             true);
  }
  if (!run_) return;
  const bool names = panel_.field && !panel_.field->x_names.empty();
  double lower = 0;
  for (const Tick& t : x_marks(std::max(2, static_cast<int>(box.w / 60)))) {
    const double x = box.x + box.w * t.value;
    svg.line("grid", x, box.y, x, box.y + box.h);
    svg.text("tick", x, box.y + box.h + 16 + lower, t.label, "middle");
    if (names) lower = 14 - lower;  // neighbours may be wider than their cells
  }
  for (const Tick& t : y_marks(std::max(2, static_cast<int>(cell.h / 50)))) {
    const double y = box.y + box.h * (1 - t.value);
    svg.line("grid", box.x, y, box.x + box.w, y);
    svg.text("tick", box.x - 6, y + 4, t.label, "end");
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
    longest = std::max(longest, std::hypot(of.u[i], of.v[i]));
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

// Both axes as "from to log start length": what a script needs to turn places
// back into values.
void PanelPlot::open_panel(Svg& svg, const Rect& box) const {
  if (keys_.empty() || !run_) {
    svg.open("g");
    return;
  }
  const auto axis = [](const Axis& a, double start, double length) {
    return fmt::format("{:.6g} {:.6g} {:d} {} {}",
                       a.lo(),
                       a.hi(),
                       a.log(),
                       svg_number(start),
                       svg_number(length));
  };
  svg.open("g",
           {{"data-x", axis(x_, box.x, box.w)},
            {"data-y", axis(y_, box.y + box.h, -box.h)},
            {"data-x-label", panel_.x_label},
            {"data-y-label", panel_.y_label}});
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
        go(pen_down ? 'L' : 'M', px(box, s.x[i]), py(box, s.y[i]));
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
    upper += go('L', x, py(box, s.hi[i]));
    lower.insert(0, go('L', x, py(box, lo)));
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
    d += go('M', x, a) + go('L', x, b);
    if (s.lo[i] >= y_.lo()) d += go('M', x - 3, a) + "h6";
    d += go('M', x - 3, b) + "h6";
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
