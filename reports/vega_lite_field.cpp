#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "reports/axis.h"
#include "reports/palette.h"
#include "reports/vega_lite_parts.h"
#include "suite/core/math.h"
#include "suite/core/power_of_ten.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

/// Between the places of a grid, and as far beyond its ends.
std::vector<double> edges_of(const std::vector<double>& at, bool log) {
  std::vector<double> warped, edges;
  for (const double v : at) warped.push_back(log ? math::log10(v) : v);
  const std::size_t n = warped.size();
  for (std::size_t k = 0; k <= n; ++k) {
    const std::size_t after = std::clamp<std::size_t>(k, 1, n > 1 ? n - 1 : 1);
    const double step = n > 1 ? warped[after] - warped[after - 1] : 1;
    const double edge =
        k < n ? warped[k] - 0.5 * step : warped[n - 1] + 0.5 * step;
    edges.push_back(log ? math::power_of_ten(edge) : edge);
  }
  return edges;
}

/// One side of a grid: the edges of its cells, or their names.
struct Side {
  std::vector<double> edges;
  std::vector<std::string> names;

  Side(const std::vector<double>& at, std::vector<std::string> given, bool log)
      : edges(edges_of(at, log)), names(std::move(given)) {
    const Axis axis(log);
    const auto shown = [&](double v) { return axis.shows(v); };
    if (!names.empty() || !log ||
        std::all_of(edges.begin(), edges.end(), shown))
      return;
    for (const double v : at) names.push_back(fmt::format("{}", v));
  }

  /// Where the k-th cell begins: an edge, or its name.
  Json begin(std::size_t k) const {
    return names.empty() ? Json(edges[k]) : Json(names[k]);
  }

  /// The whole side, also where cells are left out; upwards, the first name is
  /// the lowest.
  Json channel(const char* field,
               const std::string& title,
               bool log,
               bool upwards) const {
    if (names.empty()) {
      Json out = vega_axis(field, title, log);
      out["scale"]["domain"] = {edges.front(), edges.back()};
      return out;
    }
    Json domain = names;
    if (upwards) std::reverse(domain.begin(), domain.end());
    return {{"field", field},
            {"type", "ordinal"},
            {"title", title},
            {"axis", {{"labelLimit", 0}}},
            {"scale", {{"domain", domain}, {"round", true}}}};
  }
};

/// Each row of the grid is one row of data, whose arrays are unfolded.
Json field_rows(const Field2D& field, const Side& x, const Side& y) {
  const Axis scale(field.log_scale);
  Json rows = Json::array();
  for (std::size_t j = 0; j < field.y.size(); ++j) {
    Json from = Json::array(), to = Json::array(), values = Json::array();
    for (std::size_t i = 0; i < field.x.size(); ++i) {
      const double value = field.values[j * field.x.size() + i];
      if (!scale.shows(value)) continue;
      from.push_back(x.begin(i));
      if (x.names.empty()) to.push_back(x.edges[i + 1]);
      values.push_back(value);
    }
    if (values.empty()) continue;
    Json row{{"y", y.begin(j)}};
    if (y.names.empty()) row["y2"] = y.edges[j + 1];
    row["x"] = std::move(from);
    if (x.names.empty()) row["x2"] = std::move(to);
    row["value"] = std::move(values);
    rows.push_back(std::move(row));
  }
  return rows;
}

Json colors_of(const Field2D& field) {
  const Axis axis(field.log_scale);
  Json scale{{"type", field.log_scale ? "log" : "linear"},
             {"range", field_colors()},
             {"clamp", true}};
  if (field.min && axis.shows(*field.min)) scale["domainMin"] = *field.min;
  if (field.max && axis.shows(*field.max)) scale["domainMax"] = *field.max;
  return {{"field", "value"},
          {"type", "quantitative"},
          {"title", field.label},
          {"scale", std::move(scale)}};
}

}  // namespace

Json vega_axis(const char* field, const std::string& title, bool log) {
  Json scale{{"type", log ? "log" : "linear"}, {"nice", false}};
  if (!log) scale["zero"] = false;
  return {{"field", field},
          {"type", "quantitative"},
          {"title", title},
          {"scale", std::move(scale)}};
}

void add_vega_field(Json& layers, const Field2D& field, const Panel& panel) {
  if (field.values.size() != field.x.size() * field.y.size() ||
      field.values.empty())
    return;
  const Side x(field.x, field.x_names, panel.x_log),
      y(field.y, field.y_names, panel.y_log);
  Json rows = field_rows(field, x, y);
  if (rows.empty()) return;
  Json unfold = {"x", "value"};
  // A pixel further than its edge, so that no seam is left between cells.
  Json mark{{"type", "rect"}};
  Json encoding{{"x", x.channel("x", panel.x_label, panel.x_log, false)},
                {"y", y.channel("y", panel.y_label, panel.y_log, true)},
                {"fill", colors_of(field)}};
  if (x.names.empty()) {
    unfold.push_back("x2");
    mark["x2Offset"] = 1;
    encoding["x2"] = {{"field", "x2"}};
  }
  if (y.names.empty()) {
    mark["y2Offset"] = -1;
    encoding["y2"] = {{"field", "y2"}};
  }
  layers.push_back({{"data", {{"values", std::move(rows)}}},
                    {"transform", Json::array({{{"flatten", unfold}}})},
                    {"mark", std::move(mark)},
                    {"encoding", std::move(encoding)}});
}

void add_vega_arrows(Json& layers, const Arrows& arrows, const Panel& panel) {
  double longest = 0;
  for (std::size_t k = 0; k < arrows.x.size(); ++k)
    longest = std::max(longest, math::hypot(arrows.u[k], arrows.v[k]));
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
                     {{"x", vega_axis("x", panel.x_label, panel.x_log)},
                      {"y", vega_axis("y", panel.y_label, panel.y_log)},
                      {"x2", {{"field", "x2"}}},
                      {"y2", {{"field", "y2"}}}}}});
}

}  // namespace physinv
