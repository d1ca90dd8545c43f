// The chapter's pictures, and its notebook's table with the printed digits.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "suite/cases/physgrad/scaling/quantities.h"
#include "suite/cases/physgrad/scaling/scaling.h"
#include "suite/core/math.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/series.h"
#include "suite/harness/registry.h"

namespace physinv::scaling {
namespace {

struct Line {
  const char* method;
  const char* label;
  PlotStyle style;
};
const Line kGd{"gd", "gradient descent", {Hue::blue, Marker::circle}},
    kNewton{"newton", "Newton", {Hue::orange, Marker::square}},
    kIg{"ig", "inverse gradients", {Hue::purple, Marker::triangle}},
    kPg{"pg", "inverse simulator", {Hue::green, Marker::diamond}},
    kSlowGd{"gd_small", "gradient descent, 0.005", {Hue::teal, Marker::circle}},
    kSlowPg{
        "pg_small", "inverse simulator, 0.05", {Hue::green, Marker::diamond}};

std::map<std::string, std::string> titles() {
  std::map<std::string, std::string> all;
  for (const Line& line : {kGd, kNewton, kIg, kPg, kSlowGd, kSlowPg})
    all[line.method] = line.label;
  return all;
}

/// The path of a finished run.
std::optional<Path> path_of(const Evidence& e,
                            const char* method,
                            Index problem = 0) {
  const auto run = first_run(e, {method});
  if (!run || problem >= Path::count(*run->stage)) return {};
  return Path(*run->stage, problem);
}

Series series(const Line& line, const Batch<double>& points) {
  Series s{.label = line.label,
           .method = line.method,
           .markers = points.cols() <= 11,
           .style = line.style};
  for (Index k = 0; k < points.cols(); ++k)
    s.x.push_back(points(0, k)), s.y.push_back(points(1, k));
  return s;
}

// ---- y = (x1, alpha x2) -----------------------------------------------------

constexpr double kScales[] = {1, 3, 5};

/// |P|, as the chapter's bars say, or the loss |P|^2 as far down as the
/// trajectories go.
Panel landscape(double alpha, bool squared) {
  Field2D field{.x = spaced(-0.1, 1, 101),
                .y = spaced(squared ? -0.5 : -0.1, 1, 101),
                .label = squared ? "|P(x)|^2" : "|P(x)|"};
  for (const double x2 : field.y)
    for (const double x1 : field.x) {
      const double r = math::hypot(x1, alpha * x2);
      field.values.push_back(squared ? r * r : r);
    }
  return {.title = fmt::format("alpha = {:g}", alpha),
          .x_label = "x1",
          .y_label = "x2",
          .field = std::move(field)};
}

/// The first update as an arrow of one length for all, with its head.
Series arrow(const Line& line, const Path& path) {
  constexpr double kLength = 0.35, kHead = 0.05;
  const Vector<double> from = path.x().col(0);
  const Vector<double> way = (path.x().col(1) - from).normalized();
  const Vector<double> to = from + kLength * way;
  const Vector<double> across =
      way.reverse().cwiseProduct(Vector<double>{{-1, 1}});
  Batch<double> points(2, 5);
  points << from, to, to - kHead * (way + 0.5 * across), to,
      to - kHead * (way - 0.5 * across);
  Series s = series(line, points);
  s.markers = false;
  return s;
}

Figure landscapes(const Evidence& e) {
  Figure figure{.id = "fig1",
                .title = "Landscapes and first updates",
                .where = "Figs. 1, 2",
                .columns = 3,
                .note = "Arrows show directions, not lengths."};
  for (Index i = 0; i < 3; ++i) {
    Panel panel = landscape(kScales[i], false);
    for (const Line& line : {kGd, kNewton})
      if (const auto path = path_of(e, line.method, i))
        panel.series.push_back(arrow(line, *path));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Figure trajectories(const Evidence& e) {
  Figure figure{.id = "fig2",
                .title = "Trajectories on the losses",
                .where = "Figs. 1, 2",
                .columns = 3,
                .note =
                    "Newton, inverse gradients and the inverse simulator take "
                    "one way for every alpha."};
  for (Index i = 0; i < 3; ++i) {
    Panel panel = landscape(kScales[i], true);
    for (const Line& line : {kGd, kNewton, kIg, kPg})
      if (const auto path = path_of(e, line.method, i)) {
        panel.series.push_back(series(line, path->x()));
        panel.series.back().dashed = line.method != kGd.method;
      }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

/// Of the batches that were run.
Table times(const Evidence& e) {
  Table table{.id = "batch",
              .title = "A step of one of many trajectories",
              .unit = "CPU ns",
              .digits = 4,
              .corner = "trajectories",
              .columns = {"GD", "Newton", "IG", "PG"},
              .across = Across{.key = "method", .quantities = {"time"}}};
  TimedStages timed;
  for (const char* id : {"batch_1e3", "batch_1e5", "batch_1e6"}) {
    TableRow row{.label = id + 6};
    for (const char* stage : {"gd", "newton", "ig", "pg"}) {
      const auto run = first_run(e, {.method = id, .stage = stage});
      if (!run) continue;
      const StageRecord& s = *run->stage;
      const double steps = s.arrays.at("batch").prod();
      const auto seconds = timed.seconds(s);
      row.cells.push_back(seconds ? Cell{.ours = 1e9 * *seconds / steps}
                                  : Cell{.text = kCrowded});
    }
    if (row.cells.size() == table.columns.size())
      table.rows.push_back(std::move(row));
  }
  table.note =
      "All steps of a batch over their number; each trajectory stays in "
      "registers. " +
      timed.note();
  return table;
}

Section scaling_page(const Evidence& e) {
  return {.tables = {times(e)},
          .figures = {landscapes(e), trajectories(e)},
          .method_titles = titles()};
}

// ---- y = (x1, x2^2) ---------------------------------------------------------

Figure both_spaces(const Evidence& e) {
  Panel x{.title = "Unknowns", .x_label = "x1", .y_label = "x2"};
  Panel y{.title = "Observations", .x_label = "y1", .y_label = "y2"};
  for (const Line& line : {kGd, kNewton, kIg, kPg})
    if (const auto path = path_of(e, line.method)) {
      x.series.push_back(series(line, path->x()));
      y.series.push_back(series(line, path->squared()));
    }
  return {.id = "fig3",
          .title = "Ten steps from (3, 3)",
          .where = "Figs. 3, 4",
          .panels = {std::move(x), std::move(y)}};
}

/// `figure` with the ways in x.
Figure ways(Figure figure, const Evidence& e, const std::vector<Line>& lines) {
  Panel x{.x_label = "x1", .y_label = "x2"};
  for (const Line& line : lines)
    if (const auto path = path_of(e, line.method))
      x.series.push_back(series(line, path->x()));
  figure.panels = {std::move(x)};
  figure.columns = 1;
  return figure;
}

Figure rates(const Evidence& e) {
  return ways(
      {.id = "figure1",
       .title = "Large and small rates",
       .where = "the authors' script"},
      e,
      {{"newton_large", "Newton, rate 0.5", {Hue::orange, Marker::square}},
       {"newton_small", "Newton, 0.1", {Hue::brown, Marker::square}},
       kSlowPg,
       {"gd_large", "gradient descent, 0.5 / 36", {Hue::blue, Marker::circle}},
       kSlowGd});
}

Figure rules(const Evidence& e) {
  return ways({.id = "rules", .title = "Adaptive rules, rate 0.1"},
              e,
              {{"adam", "Adam", {Hue::red, Marker::circle}},
               {"adagrad", "Adagrad", {Hue::olive, Marker::square}},
               {"rmsprop", "RMSprop", {Hue::indigo, Marker::triangle}},
               kSlowGd,
               kSlowPg});
}

Table ends(const Evidence& e) {
  Table table{.id = "comparison",
              .title = "After ten steps from (3, 3)",
              .where = "notebook",
              .digits = 6,
              .corner = "method",
              .columns = {"x1", "x2", "distance", "first update on diagonal"},
              .note =
                  "The notebook is in single precision. Diagonal: "
                  "(u1 + u2) / |u| of the first update u."};
  const struct {
    Line line;
    std::string printed;
  } rows[] = {{kGd, "gd"},
              {kNewton, "newton"},
              {kIg, "ig"},
              {kPg, "pg"},
              {{"pg_numeric", "inverse by search", {}}, "pg-numeric"},
              {{"pg_numeric_exact", "by search, exact gradients", {}}, ""}};
  for (const auto& shown : rows) {
    const Line& line = shown.line;
    const auto path = path_of(e, line.method);
    TableRow row{.label = line.label};
    const auto add = [&](const char* quantity, double (*value)(const Path&)) {
      row.cells.push_back(beside_printed(
          cell_of(path ? std::optional(value(*path)) : std::nullopt),
          e,
          shown.printed + "/" + quantity));
    };
    add("x1", [](const Path& p) { return p.x()(0, p.steps()); });
    add("x2", [](const Path& p) { return p.x()(1, p.steps()); });
    add("distance", [](const Path& p) { return p.distance(); });
    add("diagonal", [](const Path& p) { return p.diagonal(); });
    table.rows.push_back(std::move(row));
  }
  return table;
}

Section comparison_page(const Evidence& e) {
  return {.tables = {ends(e), times(e)},
          .figures = {both_spaces(e), rates(e), rules(e)},
          .method_titles = titles()};
}

}  // namespace

void add_reports(Registry& r) {
  r.add_report(kScaling, scaling_page);
  r.add_report(kComparison, comparison_page);
}

}  // namespace physinv::scaling
