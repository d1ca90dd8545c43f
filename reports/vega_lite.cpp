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

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema =
    "https://vega.github.io/schema/vega-lite/v5.json";

/// In the order of Marker.
constexpr std::array kShapes{
    "circle", "square", "triangle-up", "diamond", "triangle-down", "cross"};
static_assert(kShapes.size() == static_cast<std::size_t>(Marker::cross) + 1);

/// A style may have the number of a hue as its marker; it stands for the next
/// round of them.
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
    scales.dashes.push_back(dash_pattern(ink, s.dashed));
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
      row["mark"] = s.markers || !s.line;
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

Json axis(const char* field, const std::string& title, bool log) {
  return {{"field", field},
          {"type", "quantitative"},
          {"title", title},
          {"scale", {{"type", log ? "log" : "linear"}, {"zero", false}}}};
}

Json y_axis(const Panel& panel, const char* field) {
  Json out = axis(field, panel.y_label, panel.y_log);
  if (panel.y_min && panel.y_max)
    out["scale"]["domain"] = {*panel.y_min, *panel.y_max};
  return out;
}

Json channel(const Scales& scales, const Json& range) {
  return {{"field", "series"},
          {"type", "nominal"},
          {"title", nullptr},
          {"scale", {{"domain", scales.names}, {"range", range}}}};
}

Json only(const char* expression) {
  return Json::array({{{"filter", expression}}});
}

/// Bands, lines and points, as far as there are any.
void add_curves(Json& layers, const Panel& panel, const Scales& scales) {
  const Json rows = rows_of(panel, scales);
  const auto any = [&](auto&& test) {
    return std::any_of(rows.begin(), rows.end(), test);
  };
  const Json x = axis("x", panel.x_label, panel.x_log), y = y_axis(panel, "y"),
             color = channel(scales, scales.colors);
  const Json data{{"values", rows}};
  if (any([](const Json& row) { return row.contains("lo"); }))
    layers.push_back({{"data", data},
                      {"transform", only("isValid(datum.lo)")},
                      {"mark", {{"type", "area"}, {"opacity", 0.2}}},
                      {"encoding",
                       {{"x", x},
                        {"y", y_axis(panel, "lo")},
                        {"y2", {{"field", "hi"}}},
                        {"color", color}}}});
  if (any([](const Json& row) { return row["line"] == true; }))
    layers.push_back({{"data", data},
                      {"transform", only("datum.line")},
                      {"mark", {{"type", "line"}}},
                      {"encoding",
                       {{"x", x},
                        {"y", y},
                        {"order", {{"field", "k"}, {"type", "quantitative"}}},
                        {"color", color},
                        {"strokeDash", channel(scales, scales.dashes)}}}});
  if (any([](const Json& row) { return row["mark"] == true; }))
    layers.push_back({{"data", data},
                      {"transform", only("datum.mark")},
                      {"mark", {{"type", "point"}, {"filled", true}}},
                      {"encoding",
                       {{"x", x},
                        {"y", y},
                        {"color", color},
                        {"shape", channel(scales, scales.shapes)}}}});
}

/// Between the places of a grid, and as far beyond its ends.
std::vector<double> edges_of(const std::vector<double>& at, bool log) {
  std::vector<double> warped, edges;
  for (const double v : at) warped.push_back(log ? std::log10(v) : v);
  const std::size_t n = warped.size();
  for (std::size_t k = 0; k <= n; ++k) {
    const std::size_t after = std::clamp<std::size_t>(k, 1, n > 1 ? n - 1 : 1);
    const double step = n > 1 ? warped[after] - warped[after - 1] : 1;
    const double edge =
        k < n ? warped[k] - 0.5 * step : warped[n - 1] + 0.5 * step;
    edges.push_back(log ? std::pow(10.0, edge) : edge);
  }
  return edges;
}

/// Each row of the grid is one row of data, whose arrays are unfolded.
Json field_rows(const Field2D& field, const Panel& panel) {
  const auto x = edges_of(field.x, panel.x_log),
             y = edges_of(field.y, panel.y_log);
  const Axis scale(field.log_scale);
  Json rows = Json::array();
  for (std::size_t j = 0; j < field.y.size(); ++j) {
    Json from = Json::array(), to = Json::array(), values = Json::array();
    for (std::size_t i = 0; i < field.x.size(); ++i) {
      const double value = field.values[j * field.x.size() + i];
      const bool named = !field.x_names.empty();
      from.push_back(named ? Json(field.x_names[i]) : Json(x[i]));
      if (!named) to.push_back(x[i + 1]);
      values.push_back(scale.shows(value) ? Json(value) : Json(nullptr));
    }
    Json row = field.y_names.empty() ? Json{{"y", y[j]}, {"y2", y[j + 1]}}
                                     : Json{{"y", field.y_names[j]}};
    row["x"] = std::move(from);
    if (!to.empty()) row["x2"] = std::move(to);
    row["value"] = std::move(values);
    rows.push_back(std::move(row));
  }
  return rows;
}

void add_field(Json& layers, const Field2D& field, const Panel& panel) {
  if (field.values.size() != field.x.size() * field.y.size() ||
      field.values.empty())
    return;
  const bool x_named = !field.x_names.empty(), y_named = !field.y_names.empty();
  Json unfold = {"x", "value"};
  if (!x_named) unfold.push_back("x2");
  Json color{{"field", "value"},
             {"type", "quantitative"},
             {"title", field.label},
             {"scale",
              {{"type", field.log_scale ? "log" : "linear"},
               {"range", field_colors()}}}};
  if (field.min) color["scale"]["domainMin"] = *field.min;
  if (field.max) color["scale"]["domainMax"] = *field.max;
  const auto place = [](const char* name, const std::string& title, bool log) {
    return axis(name, title, log);
  };
  const auto named = [](const char* name, const std::string& title) {
    return Json{{"field", name},
                {"type", "ordinal"},
                {"title", title},
                {"sort", nullptr}};
  };
  Json encoding{{"x",
                 x_named ? named("x", panel.x_label)
                         : place("x", panel.x_label, panel.x_log)},
                {"y",
                 y_named ? named("y", panel.y_label)
                         : place("y", panel.y_label, panel.y_log)},
                {"color", std::move(color)}};
  if (!x_named) encoding["x2"] = {{"field", "x2"}};
  if (!y_named) encoding["y2"] = {{"field", "y2"}};
  layers.push_back({{"data", {{"values", field_rows(field, panel)}}},
                    {"transform", Json::array({{{"flatten", unfold}}})},
                    {"mark", "rect"},
                    {"encoding", std::move(encoding)}});
}

void add_arrows(Json& layers, const Arrows& arrows, const Panel& panel) {
  double longest = 0;
  for (std::size_t k = 0; k < arrows.x.size(); ++k)
    longest = std::max(longest, std::hypot(arrows.u[k], arrows.v[k]));
  if (!(longest > 0) || !std::isfinite(longest)) return;
  const double scale = arrows.length / longest;
  Json rows = Json::array();
  for (std::size_t k = 0; k < arrows.x.size(); ++k)
    rows.push_back({{"x", arrows.x[k]},
                    {"y", arrows.y[k]},
                    {"x2", arrows.x[k] + scale * arrows.u[k]},
                    {"y2", arrows.y[k] + scale * arrows.v[k]}});
  layers.push_back({{"data", {{"values", std::move(rows)}}},
                    {"mark", {{"type", "rule"}, {"color", "white"}}},
                    {"encoding",
                     {{"x", axis("x", panel.x_label, panel.x_log)},
                      {"y", axis("y", panel.y_label, panel.y_log)},
                      {"x2", {{"field", "x2"}}},
                      {"y2", {{"field", "y2"}}}}}});
}

/// A panel without a point says so.
Json panel_of(const Panel& panel, const Scales& scales) {
  Json layers = Json::array();
  if (panel.field) add_field(layers, *panel.field, panel);
  if (panel.arrows) add_arrows(layers, *panel.arrows, panel);
  add_curves(layers, panel, scales);
  if (layers.empty())
    layers.push_back({{"data", {{"values", Json::array({Json::object()})}}},
                      {"mark", {{"type", "text"}, {"text", "not run"}}}});
  return {{"title", panel.title},
          {"width", 330},
          {"height", 230},
          {"layer", std::move(layers)}};
}

}  // namespace

Json vega_lite(const Figure& figure, const Palette& report) {
  Palette palette = palette_of(figure, report);
  const Scales scales = scales_of(figure, palette);
  Json panels = Json::array();
  for (const Panel& panel : figure.panels)
    panels.push_back(panel_of(panel, scales));
  const std::string title =
      figure.where.empty() ? figure.title : figure.where + " · " + figure.title;
  return {{"$schema", kSchema},
          {"title", title},
          {"description", figure.note},
          {"columns", std::max(1, figure.columns)},
          {"concat", std::move(panels)}};
}

}  // namespace physinv
