#include "reports/printed_curves.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "reports/panel.h"
#include "suite/store/file.h"
#include "suite/store/json.h"

namespace physinv {
namespace {

using Json = nlohmann::ordered_json;

double real(const Json& j) {
  if (!j.is_number())
    throw std::runtime_error("a curve contains something other than numbers");
  return j;
}

template <std::size_t N>
std::array<double, N> reals(const Json& list) {
  if (!list.is_array() || list.size() != N)
    throw std::runtime_error(
        fmt::format("a curve has {}; expected {} numbers", list.dump(), N));
  std::array<double, N> out;
  std::transform(list.begin(), list.end(), out.begin(), real);
  return out;
}

PrintedPoint ordered(PrintedPoint p) {
  if (!(p.lowest <= p.y && p.y <= p.highest))
    throw std::runtime_error(fmt::format(
        "a curve's {} is not between {} and {}", p.y, p.lowest, p.highest));
  return p;
}

PrintedCurve curve_from(const Json& j) {
  PrintedCurve c{.experiment = j.at("experiment"),
                 .figure = j.at("figure"),
                 .method = j.at("method"),
                 .label = j.at("label"),
                 .where = j.at("where")};
  if (j.contains("panels")) c.panels = j["panels"];
  if (j.contains("span")) {
    c.between = reals<2>(j["span"]);
  } else if (j.contains("level")) {
    const auto [lowest, y, highest] = reals<3>(j["level"]);
    c.level = ordered({0, lowest, y, highest});
    if (j.contains("between")) c.between = reals<2>(j["between"]);
  } else {
    for (const Json& point : j.at("points")) {
      const auto [x, lowest, y, highest] = reals<4>(point);
      c.points.push_back(ordered({x, lowest, y, highest}));
    }
  }
  return c;
}

bool is_for(const PrintedCurve& c, const Panel& panel) {
  return c.panels.empty() ||
         std::any_of(c.panels.begin(), c.panels.end(), [&](const auto& name) {
           return name == panel.title ||
                  (panel.title.empty() && name == panel.x_label);
         });
}

/// Least and most of what the panel shows.
struct Range {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  void include(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
};

std::pair<Range, Range> ranges_of(const Panel& panel) {
  const Axis x(panel.x_log), y(panel.y_log);
  Range across, up;
  for (const Series& s : panel.series)
    for (std::size_t k = 0; k < std::min(s.x.size(), s.y.size()); ++k)
      if (x.shows(s.x[k]) && y.shows(s.y[k])) {
        across.include(s.x[k]);
        up.include(s.y[k]);
      }
  return {across, up};
}

void add(Series& s, const PrintedPoint& p) {
  s.x.push_back(p.x);
  s.y.push_back(p.y);
  s.lo.push_back(p.lowest);
  s.hi.push_back(p.highest);
}

/// The series for a panel that shows these ranges.
Series series_of(const PrintedCurve& c, const Range& across, const Range& up) {
  Series s{.label = c.label, .method = c.method, .dashed = true};
  for (const PrintedPoint& p : c.points) add(s, p);
  s.markers = !c.points.empty();
  if (c.level) {
    PrintedPoint p = *c.level;
    const auto ends = c.between.value_or(std::array{across.least, across.most});
    for (const double x : ends) p.x = x, add(s, p);
  } else if (c.between) {
    const auto [from, to] = *c.between;
    s.x = {from, from, to, to};
    s.y = {up.least, up.most, up.most, up.least};
  }
  return s;
}

}  // namespace

std::vector<PrintedCurve> printed_curves(std::string_view bytes,
                                         const std::filesystem::path& path) {
  try {
    std::vector<PrintedCurve> curves;
    for (const Json& j : parse_json<Json>(bytes).value("curves", Json::array()))
      curves.push_back(curve_from(j));
    return curves;
  } catch (const std::exception& e) {
    throw StoreError(
        fmt::format("{} is damaged: {} (restore it)", path.string(), e.what()));
  }
}

std::vector<PrintedCurve> printed_curves(
    const std::filesystem::path& directory,
    const std::vector<std::string>& papers) {
  std::vector<PrintedCurve> all;
  for (const std::string& paper : papers) {
    const auto path = directory / (paper + ".json");
    if (!std::filesystem::exists(path)) continue;
    for (auto& c : printed_curves(read_file(path), path))
      all.push_back(std::move(c));
  }
  return all;
}

void draw_printed(const std::vector<PrintedCurve>& curves, Section& section) {
  for (Figure& figure : section.figures) {
    std::vector<std::string> places;
    for (Panel& panel : figure.panels) {
      const auto [across, up] = ranges_of(panel);
      std::vector<Series> printed;
      for (const PrintedCurve& c : curves) {
        if (c.experiment != section.experiment || c.figure != figure.id ||
            !is_for(c, panel))
          continue;
        const auto own = std::find_if(
            panel.series.begin(), panel.series.end(), [&](const Series& s) {
              return s.method == c.method && shows(panel, s);
            });
        if (own == panel.series.end()) continue;
        printed.push_back(series_of(c, across, up));
        printed.back().style = own->style;
        if (std::find(places.begin(), places.end(), c.where) == places.end())
          places.push_back(c.where);
      }
      for (Series& s : printed) panel.series.push_back(std::move(s));
    }
    if (!places.empty())
      figure.note +=
          fmt::format("{}The paper's, with the error of reading: {}.",
                      figure.note.empty() ? "" : " ",
                      fmt::join(places, "; "));
  }
}

}  // namespace physinv
