#include "reports/vega_lite.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "reports/axis.h"
#include "reports/legend.h"
#include "reports/panel.h"
#include "reports/vega_lite_parts.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema =
    "https://vega.github.io/schema/vega-lite/v5.json";

/// In the order of Marker.
constexpr std::array kShapes{
    "circle", "square", "triangle-up", "diamond", "triangle-down", "cross"};
static_assert(kShapes.size() == static_cast<std::size_t>(Marker::cross) + 1);

/// A style may have the number of a hue as its marker; it means the next round
/// of them.
const char* shape_of(Marker marker) {
  return kShapes[static_cast<std::size_t>(marker) % kShapes.size()];
}

/// What each entry of the legend is called, and how it looks.
struct Scales {
  std::vector<const Series*> legend;
  Json names = Json::array(), colors = Json::array(), dashes = Json::array(),
       shapes = Json::array();

  std::string name_of(const Series& s) const {
    const int k = legend_index(legend, s);
    return k < 0 ? s.method
                 : names[static_cast<std::size_t>(k)].get<std::string>();
  }
};

/// All lines have round ends, which make dots of short inks; others are as much
/// shorter.
Json dashes_of(Ink ink, bool dashed) {
  constexpr double kStroke = 2;  // Vega-Lite's width of lines
  std::vector<double> lengths = dash_pattern(ink, dashed);
  if (std::all_of(lengths.begin(), lengths.end(), [](double length) {
        return length > kStroke;
      }))
    for (std::size_t k = 0; k < lengths.size(); ++k)
      lengths[k] += k % 2 == 0 ? -kStroke : kStroke;
  return lengths;
}

/// Entries of one label have their method, too.
Scales scales_of(const Figure& figure, Palette& palette) {
  Scales scales{.legend = legend_of(figure)};
  const auto add = [&](std::string name, const Series& s) {
    const auto taken = [&] {
      return std::find(scales.names.begin(), scales.names.end(), name) !=
             scales.names.end();
    };
    if (taken()) name += fmt::format(" ({})", s.method);
    if (taken()) name += s.dashed ? ", dashed" : ", whole";
    const Ink ink = palette.of(s);
    scales.names.push_back(std::move(name));
    scales.colors.push_back(light_color(ink.color));
    scales.dashes.push_back(dashes_of(ink, s.dashed));
    scales.shapes.push_back(shape_of(ink.marker));
  };
  for (const Series* s : scales.legend) add(s->label, *s);
  for (const Panel& panel : figure.panels)
    for (const Series& s : panel.series)
      if (legend_index(scales.legend, s) < 0 &&
          std::find(scales.names.begin(), scales.names.end(), s.method) ==
              scales.names.end())
        add(s.method, s);
  return scales;
}

/// "none", "full" or "hollow".
const char* mark_of(const Series& s) {
  if (s.line && !s.markers) return "none";
  return s.dashed ? "hollow" : "full";
}

/// A row for each point that can be drawn.
Json rows_of(const Panel& panel, const Scales& scales) {
  const Axis x(panel.x_log), y(panel.y_log);
  Json rows = Json::array();
  for (const Series& s : panel.series) {
    const std::string name = scales.name_of(s);
    for (std::size_t k = 0; k < std::min(s.x.size(), s.y.size()); ++k) {
      if (!x.shows(s.x[k]) || !y.shows(s.y[k])) continue;
      Json row{{"series", name}, {"k", k}, {"x", s.x[k]}, {"y", s.y[k]}};
      if (k < s.lo.size() && k < s.hi.size() && y.shows(s.lo[k]) &&
          y.shows(s.hi[k]))
        row["lo"] = s.lo[k], row["hi"] = s.hi[k];
      row["line"] = s.line;
      row["mark"] = mark_of(s);
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

/// With room for markers at the ends.
Json roomy(Json axis, bool field) {
  if (!field) axis["scale"]["padding"] = 8;
  return axis;
}

/// Names at 0, 1, ...: those of a field without values.
Json names_axis(const std::vector<std::string>& names) {
  Json places = Json::array();
  for (std::size_t k = 0; k < names.size(); ++k) places.push_back(k);
  return {{"values", std::move(places)},
          {"labelExpr", Json(names).dump() + "[datum.value]"}};
}

Json x_axis(const Panel& panel) {
  Json out = vega_axis("x", panel.x_label, panel.x_log);
  if (panel.field && panel.field->values.empty() &&
      !panel.field->x_names.empty())
    out["axis"] = names_axis(panel.field->x_names);
  const Axis x(panel.x_log);
  if (!panel.x_min || !panel.x_max || !x.shows(*panel.x_min) ||
      !x.shows(*panel.x_max))
    return roomy(std::move(out), panel.field.has_value());
  out["scale"]["domain"] = {*panel.x_min, *panel.x_max};
  return out;
}

bool is_limited(const Panel& panel) {
  const Axis y(panel.y_log);
  return panel.y_min && panel.y_max && y.shows(*panel.y_min) &&
         y.shows(*panel.y_max);
}

Json y_axis(const Panel& panel, const char* field) {
  Json out = vega_axis(field, panel.y_label, panel.y_log);
  if (!is_limited(panel)) return roomy(std::move(out), panel.field.has_value());
  out["scale"]["domain"] = {*panel.y_min, *panel.y_max};
  return out;
}

/// The legend of a figure is drawn (legend_of).
Json channel(const Scales& scales, const Json& range) {
  return {{"field", "series"},
          {"type", "nominal"},
          {"legend", nullptr},
          {"scale", {{"domain", scales.names}, {"range", range}}}};
}

Json line_mark(const char* type) {
  return {{"type", type}, {"strokeWidth", 2}, {"strokeCap", "round"}};
}

Json point_mark(bool hollow) {
  Json mark{{"type", "point"}, {"filled", !hollow}, {"opacity", 1}};
  if (hollow) mark["fill"] = "white";
  return mark;
}

Json only(const char* expression) {
  return Json::array({{{"filter", expression}}});
}

/// Those of a legend, or of a panel; `x` and `y` are their places.
void add_points(Json& layers,
                const Json& rows,
                const Scales& scales,
                const Json& x,
                const Json& y) {
  for (const char* kind : {"full", "hollow"}) {
    if (std::none_of(rows.begin(), rows.end(), [&](const Json& row) {
          return row["mark"] == kind;
        }))
      continue;
    const std::string filter = fmt::format("datum.mark == '{}'", kind);
    layers.push_back({{"data", {{"values", rows}}},
                      {"transform", only(filter.c_str())},
                      {"mark", point_mark(kind == std::string("hollow"))},
                      {"encoding",
                       {{"x", x},
                        {"y", y},
                        {"color", channel(scales, scales.colors)},
                        {"shape", channel(scales, scales.shapes)}}}});
  }
}

/// Bands, lines and points, as far as there are any.
void add_curves(Json& layers, const Panel& panel, const Scales& scales) {
  const Json rows = rows_of(panel, scales);
  const auto any = [&](auto&& test) {
    return std::any_of(rows.begin(), rows.end(), test);
  };
  const Json x = x_axis(panel), y = y_axis(panel, "y"),
             color = channel(scales, scales.colors);
  const Json data{{"values", rows}};
  const auto clipped = [&](Json mark) {
    if (is_limited(panel)) mark["clip"] = true;
    return mark;
  };
  if (any([](const Json& row) { return row.contains("lo"); }))
    layers.push_back({{"data", data},
                      {"transform", only("isValid(datum.lo)")},
                      {"mark", clipped({{"type", "area"}, {"opacity", 0.2}})},
                      {"encoding",
                       {{"x", x},
                        {"y", y_axis(panel, "lo")},
                        {"y2", {{"field", "hi"}}},
                        {"color", color}}}});
  if (any([](const Json& row) { return row["line"] == true; }))
    layers.push_back({{"data", data},
                      {"transform", only("datum.line")},
                      {"mark", clipped(line_mark("line"))},
                      {"encoding",
                       {{"x", x},
                        {"y", y},
                        {"order", {{"field", "k"}, {"type", "quantitative"}}},
                        {"color", color},
                        {"strokeDash", channel(scales, scales.dashes)}}}});
  add_points(layers, rows, scales, x, y);
}

/// A line with its marker and name for each entry, as SVG has it: legends of
/// Vega-Lite show no line with its marker.
Json legend_view(const Scales& scales) {
  Json rows = Json::array(), layers = Json::array();
  for (const Series* s : scales.legend)
    rows.push_back({{"series", scales.name_of(*s)},
                    {"line", s->line},
                    {"mark", mark_of(*s)}});
  const Json data{{"values", rows}};
  const Json y{{"field", "series"},
               {"type", "nominal"},
               {"sort", nullptr},
               {"axis", nullptr}};
  layers.push_back({{"data", data},
                    {"transform", only("datum.line")},
                    {"mark", line_mark("rule")},
                    {"encoding",
                     {{"x", {{"value", 0}}},
                      {"x2", {{"value", 36}}},
                      {"y", y},
                      {"color", channel(scales, scales.colors)},
                      {"strokeDash", channel(scales, scales.dashes)}}}});
  add_points(layers, rows, scales, {{"value", 18}}, y);
  layers.push_back(
      {{"data", data},
       {"mark", {{"type", "text"}, {"align", "left"}, {"limit", 290}}},
       {"encoding",
        {{"x", {{"value", 44}}},
         {"y", y},
         {"text", {{"field", "series"}, {"type", "nominal"}}}}}});
  return {{"width", 330},
          {"height", {{"step", 20}}},
          {"view", {{"stroke", nullptr}}},
          {"layer", std::move(layers)}};
}

/// A panel without a point says so.
Json panel_of(const Panel& panel, const Scales& scales) {
  Json layers = Json::array();
  if (panel.field) add_vega_field(layers, *panel.field, panel);
  if (panel.arrows) add_vega_arrows(layers, *panel.arrows, panel);
  add_curves(layers, panel, scales);
  if (layers.empty())
    layers.push_back({{"data", {{"values", Json::array({Json::object()})}}},
                      {"mark", {{"type", "text"}, {"text", "not run"}}}});
  return {
      {"title", panel.title},
      {"width", 330},
      {"height", panel.space ? std::max(1, int(330 * slope_of(panel))) : 230},
      {"layer", std::move(layers)}};
}

}  // namespace

Json vega_lite(const Figure& figure, const Palette& report) {
  Palette palette = palette_of(figure, report);
  const Scales scales = scales_of(figure, palette);
  Json panels = Json::array();
  for (const Panel& panel : figure.panels)
    panels.push_back(panel_of(panel, scales));
  if (!scales.legend.empty()) panels.push_back(legend_view(scales));
  const std::string title =
      figure.where.empty() ? figure.title : figure.where + " · " + figure.title;
  return {{"$schema", kSchema},
          {"title", title},
          {"description", figure.note},
          {"columns", std::max(1, figure.columns)},
          {"concat", std::move(panels)},
          {"resolve", {{"scale", {{"fill", "independent"}}}}}};
}

}  // namespace physinv
