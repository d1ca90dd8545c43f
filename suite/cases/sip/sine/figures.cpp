#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "suite/cases/sip/sine/score.h"
#include "suite/core/math.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/landscape.h"
#include "suite/evidence/method_table.h"
#include "suite/evidence/picture.h"
#include "suite/evidence/series.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"

namespace physinv::sine {
namespace {

const std::vector<MethodLine> kLines = {
    {"sip", "SIP", Hue::orange},
    {"sip-l2", "SIP, half the square", Hue::red},
    {"adam", "Adam", Hue::purple},
    {"sgd", "SGD", Hue::blue},
    {"adadelta", "Adadelta", Hue::teal},
    {"adagrad", "Adagrad", Hue::green},
    {"rmsprop", "RMSprop", Hue::brown}};
const std::vector<MethodLine> kFinite = {
    {"sip-finite", "SIP, 1000 samples", Hue::pink},
    {"adam-finite", "Adam, 1000 samples", Hue::indigo}};

/// What the authors' figure shows, read off to about 10 %.
std::optional<double> printed_score(const Evidence& at,
                                    const Point& p,
                                    const std::string& method) {
  const auto v = at.published.find(p.experiment(), "fig5/" + method);
  if (!v) return {};
  return v->value;
}

std::vector<double> scores(const Evidence& at,
                           const Point& p,
                           const std::string& method) {
  return values_of(sample(at, Select{method}.in(p.experiment()), score()));
}

/// Medians of each method over points, with those of the paper dashed.
Panel sweep(const Evidence& at,
            const std::vector<Point>& points,
            double (*place)(const Point&),
            double (*scale)(const Point&)) {
  Panel panel{.y_log = true};
  for (const MethodLine& line : kLines) {
    Series ours = series_of(line), theirs = ours;
    ours.markers = true;
    theirs.label += ", paper", theirs.dashed = true;
    for (const Point& p : points) {
      if (auto all = scores(at, p, line.method); !all.empty()) {
        ours.x.push_back(place(p));
        ours.y.push_back(median(all) * scale(p));
      }
      if (const auto v = printed_score(at, p, line.method)) {
        theirs.x.push_back(place(p));
        theirs.y.push_back(*v * scale(p));
        theirs.lo.push_back(0.9 * theirs.y.back());
        theirs.hi.push_back(1.1 * theirs.y.back());
      }
    }
    if (ours.x.empty()) continue;
    panel.series.push_back(std::move(ours));
    if (!theirs.x.empty()) panel.series.push_back(std::move(theirs));
  }
  return panel;
}

Figure sweeps(const Evidence& at) {
  std::vector<Point> stretches, turns;
  for (const int xi : kStretches) stretches.push_back({xi, 0});
  for (const int degrees : kTurns) turns.push_back({kStretch, degrees});
  Panel a = sweep(
      at,
      stretches,
      [](const Point& p) { return double(p.xi); },
      [](const Point& p) { return 1.0 / p.xi; });
  a.title = "No turn", a.x_label = "xi", a.y_label = "distance / xi";
  a.x_log = true;
  Panel b = sweep(
      at,
      turns,
      [](const Point& p) { return double(p.degrees); },
      [](const Point&) { return 1.0; });
  b.title = "xi = 32", b.x_label = "phi in degrees", b.y_label = "distance";
  return {.id = "fig5-sweeps",
          .title = "Distance to the nearest solution",
          .where = "Fig. 5",
          .panels = {std::move(a), std::move(b)},
          .note =
              "Mean over the last tenth of the updates, median over seeds. "
              "Dashed: read off the authors' figure, to about 10 % (band)."};
}

/// The loss around the origin, for one observation.
Figure landscape() {
  const SinePlaneOptions options{.degrees = 15};
  const auto axis = spaced(-1, 1, 121);
  return {.id = "landscape",
          .title = "The loss for y* = (0.3, -0.5), xi = 1, phi = 15 degrees",
          .panels = {{.x_label = "x_1",
                      .y_label = "x_2",
                      .field = loss_over_plane(
                          *problems::sine_plane(options).make<double>(),
                          {Eigen::Vector2d(0.3, -0.5)},
                          axis,
                          axis)}},
          .columns = 1};
}

constexpr double kPeriod = 2 * std::numbers::pi;

/// u = (gamma / xi w_1, gamma xi w_2), w = R x, in which the problem is
/// (sin u_1, u_2) for every stretch and turn.
std::array<double, 2> unstretched(const SinePlaneOptions& o, const Pair& x) {
  const double phi = o.degrees * std::numbers::pi / 180;
  const double c = math::cos(phi), s = math::sin(phi);
  return {o.gamma / o.xi * (c * x[0] - s * x[1]),
          o.gamma * o.xi * (s * x[0] + c * x[1])};
}

/// The loss of one target, an answer, and the solution nearest to it.
Panel answer(const Point& p, const FoundBy& found, const Pictured& problem) {
  constexpr double kHighest = 1.5;  // of u_2, which targets hold within 1
  const SinePlaneOptions o = options_of(p);
  const Pair x = {found.x(0), found.x(1)};
  const Pair nearest = nearest_solution(o, x, {problem.y(0), problem.y(1)});
  Panel panel{
      .title = fmt::format("{}: distance {:.2g}",
                           found.who,
                           math::hypot(x[0] - nearest[0], x[1] - nearest[1])),
      .x_label = "u_1",
      .y_label = "u_2",
      .field =
          loss_over_plane(*problems::sine_plane({.gamma = 1}).make<double>(),
                          {problem.y},
                          spaced(-kPeriod, kPeriod, 81),
                          spaced(-kHighest, kHighest, 41))};
  const auto at = unstretched(o, x), wanted = unstretched(o, nearest);
  const double turns = kPeriod * std::round(at[0] / kPeriod);
  const auto add = [&](const char* name, const auto& u, PlotStyle style) {
    panel.series.push_back(
        mark(name,
             name,
             few_digits(std::clamp(u[0] - turns, -kPeriod, kPeriod)),
             few_digits(std::clamp(u[1], -kHighest, kHighest)),
             style));
  };
  add("nearest solution", wanted, {Hue::ink, Marker::cross});
  add("answer", at, {Hue::orange, Marker::circle});
  return panel;
}

/// What the networks answer for one target of the test set.
Figure answers(const Evidence& at,
               const Point& p,
               const std::vector<MethodLine>& lines) {
  std::vector<PicturedMethod> methods;
  for (const MethodLine& line : lines)
    methods.push_back({line.label, Select{line.method}});
  return picture(
      {.title = "What each network answers for one target",
       .note = "The plane is turned and stretched so that the problem is "
               "(sin u_1, u_2); u_1 is shifted by whole periods. Answers "
               "outside of the panel are at its edge; titles have their "
               "distance to the nearest solution.",
       .draw = std::bind_front(answer, p)},
      pictured(at, methods));
}

Table score_table(const Evidence& at,
                  const Point& p,
                  const std::vector<MethodLine>& lines) {
  const auto paper = [&](const Evidence&, const Select& runs) {
    return written(printed_score(at, p, runs.method), "{:.3g}", kNothing);
  };
  return table_by_method(
      {.id = "scores",
       .title = "Distance to the nearest solution",
       .where = "Fig. 5",
       .corner = "method",
       .note = "Mean over the last tenth of the updates, median and "
               "range over seeds. The figure is read to about 10 %."},
      at,
      lines,
      {median_column("distance", score()),
       quantity_column("lowest", [](auto& s) { return lowest(s, score()); }),
       quantity_column("highest", [](auto& s) { return highest(s, score()); }),
       {"paper's figure", paper},
       quantity_column("distance / xi", [&](auto& s) {
         return ratio(median(s, score()), p.xi);
       })});
}

Table rate_table(const Evidence& at) {
  Table table{.id = "rates",
              .title = "Distance to the nearest solution, by learning rate",
              .where = "App. B.1",
              .corner = "method",
              .note = "No turn, 8000 updates, median over seeds.",
              .keys = {"method", "xi"},
              .across = Across{.key = "rate", .quantities = {"distance"}}};
  for (const RateFactor& f : kFactors) table.columns.push_back(f.label);
  for (const int xi : kStudied)
    for (const MethodName& m : kSix) {
      TableRow row{.label = fmt::format("{}, xi = {}", m.label, xi),
                   .keys = {m.label, std::to_string(xi)}};
      for (const RateFactor& f : kFactors)
        row.cells.push_back(written(score_at_rate(xi, m.id, f.name)(at)));
      table.rows.push_back(std::move(row));
    }
  return table;
}

Table gamma_table(const Evidence& at) {
  Table table{.id = "gamma",
              .title = "Adam's test loss, by gamma",
              .where = "App. B.1",
              .corner = "xi",
              .note = "No turn, 8000 updates, median over seeds.",
              .across = Across{.key = "gamma", .quantities = {"loss"}}};
  for (const int gamma : kGammas) {
    table.columns.push_back(fmt::format("gamma = {}", gamma));
    table.across->values.push_back(std::to_string(gamma));
  }
  for (const int xi : kStudied) {
    TableRow row{.label = fmt::format("{}", xi)};
    for (const int gamma : kGammas)
      row.cells.push_back(written(loss_of_gamma(xi, gamma)(at)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Section report(const Point& p, const Evidence& at) {
  const bool main = p.experiment() == kHard.experiment();
  const auto lines = main ? joined(kLines, kFinite) : kLines;
  Section section{.tables = {score_table(at, p, lines), loss_table(at, lines)},
                  .method_titles = titles_of(lines)};
  if (main) {
    section.tables.push_back(rate_table(at));
    section.tables.push_back(gamma_table(at));
    section.figures = {sweeps(at), landscape()};
  }
  section.figures.insert(section.figures.begin(), answers(at, p, lines));
  LearningCurves curves(at, section);
  curves.metric(lines, 0, "mean distance", "distances", "Distances", "Fig. 5");
  curves.losses(lines, "losses", "Learning curves", "");
  return section;
}

}  // namespace

void add_reports(Registry& r) {
  for (const Point& p : points())
    r.add_report(p.experiment(), std::bind_front(report, p));
}

}  // namespace physinv::sine
