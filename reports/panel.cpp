#include "reports/panel.h"

#include <fmt/format.h>

#include <algorithm>

#include "reports/heat_map.h"
#include "reports/marks.h"
#include "reports/text.h"

namespace physinv {
namespace {

constexpr double kTickWidth = 6.3;  // of a character of the tick font
constexpr double kNameHeight = 15;  // of a row that has a name

// Names of rows or columns are at the middle of their cells.
std::vector<Tick> named(const std::vector<std::string>& names) {
  std::vector<Tick> ticks;
  for (std::size_t i = 0; i < names.size(); ++i)
    ticks.push_back(
        {(static_cast<double>(i) + 0.5) / static_cast<double>(names.size()),
         names[i]});
  return ticks;
}

}  // namespace

bool shows(const Panel& panel, const Series& series) {
  const Axis x(panel.x_log), y(panel.y_log);
  for (std::size_t i = 0; i < points(series); ++i)
    if (x.shows(series.x[i]) && y.shows(series.y[i])) return true;
  return false;
}

namespace {

bool is_reference(const Series& s) {
  return s.dashed && s.line && !s.markers && s.lo.empty() &&
         std::all_of(
             s.y.begin(), s.y.end(), [&](double v) { return v == s.y[0]; });
}

}  // namespace

bool has_points(const Panel& panel) {
  if (panel.field && !panel.field->values.empty()) return true;
  bool references = false, missing = false;
  for (const Series& s : panel.series) {
    const bool shown = shows(panel, s);
    if (shown && !is_reference(s)) return true;
    references |= shown;
    missing |= !shown;
  }
  return references && !missing;
}

std::optional<double> constant_of(const Panel& panel) {
  if (panel.field || panel.arrows) return {};
  std::optional<double> value;
  std::size_t count = 0;
  for (const Series& s : panel.series) {
    if (!s.lo.empty()) return {};
    for (std::size_t i = 0; i < points(s); ++i) {
      if (value && s.y[i] != *value) return {};
      value = s.y[i];
      ++count;
    }
  }
  return count > 1 ? value : std::nullopt;
}

double slope_of(const Panel& panel) {
  if (panel.field && !panel.field->x.empty())
    return static_cast<double>(panel.field->y.size()) /
           static_cast<double>(panel.field->x.size());
  if (!panel.x_min || !panel.x_max || !panel.y_min || !panel.y_max ||
      !(*panel.x_max > *panel.x_min) || !(*panel.y_max > *panel.y_min))
    return 1;
  return (*panel.y_max - *panel.y_min) / (*panel.x_max - *panel.x_min);
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
  run_ = has_points(panel_);
  Axis data_y(panel_.y_log);
  for (const Series& s : panel_.series) {
    for (std::size_t i = 0; i < points(s); ++i) {
      if (!x_.shows(s.x[i]) || !y_.shows(s.y[i])) continue;
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
    for (const double x : panel_.field->x) x_.include(x);
    for (const double y : panel_.field->y) y_.include(y);
    x_.finish_tight();
    y_.finish_tight();
  } else {
    x_.finish(panel_.x_min, panel_.x_max);
    y_.finish(panel_.y_min, panel_.y_max);
  }
}

double PanelPlot::px(const Rect& box, double value) const {
  return box.x + box.w * x_.place(value);
}

double PanelPlot::py(const Rect& box, double value) const {
  return box.y + box.h * (1 - y_.place(value));
}

// What title, labels and colour bar leave of a place's cell.
Rect PanelPlot::place_in(const Rect& cell) const {
  const double top = panel_.title.empty() ? 10 : 28, margin = 10,
               right = panel_.field ? 74 : margin, slope = slope_of(panel_);
  const double w = std::max(
      1.0, std::min(cell.w - margin - right, (cell.h - top - margin) / slope));
  return {cell.x + margin, cell.y + top, w, w * slope};
}

// What the axes leave of a cell.
Rect PanelPlot::box_in(const Rect& cell) const {
  if (panel_.space) return place_in(cell);
  std::size_t tick_width = 2;
  const int y_ticks = std::max(2, static_cast<int>(cell.h / 50));
  for (const Tick& t : y_marks(y_ticks)) {
    tick_width = std::max(tick_width, display_width(t.label));
  }
  const double left = (panel_.y_label.empty() ? 10 : 28) +
                      kTickWidth * static_cast<double>(tick_width);
  const double right = panel_.field ? 74 : 14;
  const double top = panel_.title.empty() ? 10 : 28;
  const double bottom =
      (panel_.x_label.empty() ? 26 : 44) +
      std::max(0.0, turned_names(cell.w - left - right) - kTickWidth);
  return {cell.x + left,
          cell.y + top,
          cell.w - left - right,
          cell.h - top - bottom};
}

double PanelPlot::height(double width, double usual) const {
  if (panel_.space) {
    constexpr double kHighest = 1e4;
    return place_in({0, 0, width, kHighest}).h +
           (panel_.title.empty() ? 20 : 38);
  }
  const double names =
      panel_.field
          ? kNameHeight * static_cast<double>(panel_.field->y_names.size())
          : 0;
  return usual + std::max(0.0, names - box_in({0, 0, width, usual}).h);
}

void PanelPlot::draw(Svg& svg, const Rect& cell) const {
  const Rect box = box_in(cell);
  open_panel(svg, box);
  furniture(svg, box, cell);
  svg.open("clipPath", {{"id", id_}});
  svg.rect("", box.x, box.y, box.w, box.h);
  svg.close();
  if (panel_.field && !panel_.field->values.empty()) {
    draw_heat_map(svg, *panel_.field, box.x, box.y, box.w, box.h);
  }
  if (panel_.arrows) arrows(svg, box, *panel_.arrows);
  if (run_) curves(svg, box);
  svg.rect("frame", box.x, box.y, box.w, box.h);
  if (!run_) {
    svg.text(
        "label", box.x + box.w / 2, box.y + box.h / 2 + 4, "not run", "middle");
  }
  svg.close();
}

// The height of the longest name of a column; names that are wider than their
// columns are upright. 0 if none is.
double PanelPlot::turned_names(double width) const {
  if (!panel_.field || panel_.field->x_names.empty()) return 0;
  std::size_t longest = 0;
  for (const auto& name : panel_.field->x_names)
    longest = std::max(longest, display_width(name));
  const double need = kTickWidth * static_cast<double>(longest);
  return need > width / static_cast<double>(panel_.field->x_names.size()) ? need
                                                                          : 0;
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
             cell.y + cell.h - 8,
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
  if (run_ && !panel_.space) ticks(svg, box, cell);
}

// The lines of the grid are one path.
void PanelPlot::ticks(Svg& svg, const Rect& box, const Rect& cell) const {
  const auto across = x_marks(std::max(2, static_cast<int>(box.w / 60))),
             up = y_marks(std::max(2, static_cast<int>(cell.h / 50)));
  std::string grid;
  for (const Tick& t : across)
    grid += path_step('M', box.x + box.w * t.value, box.y) + 'v' +
            svg_number(box.h);
  for (const Tick& t : up)
    grid += path_step('M', box.x, box.y + box.h * (1 - t.value)) + 'h' +
            svg_number(box.w);
  svg.path("grid", grid);
  const bool turned = turned_names(box.w) > 0;
  for (const Tick& t : across) {
    const double x = box.x + box.w * t.value, y = box.y + box.h;
    if (turned)
      svg.text("tick", x + 4, y + 6, t.label, "end", true);
    else
      svg.text("tick", x, y + 16, t.label, "middle");
  }
  for (const Tick& t : up)
    svg.text(
        "tick", box.x - 6, box.y + box.h * (1 - t.value) + 4, t.label, "end");
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

}  // namespace physinv
