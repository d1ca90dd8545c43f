// A shot and Fig. 4a of the JPO paper, in addition to what all its experiments
// show.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "problems/billiards/billiards.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/core/math.h"
#include "suite/evidence/landscape.h"
#include "suite/evidence/picture.h"
#include "suite/evidence/series.h"
#include "suite/harness/registry.h"

namespace physinv::jpo::billiards {
namespace {

/// Fig. 4a: the loss over the cue ball's velocity, for one position.
Figure landscape() {
  const auto target = BilliardsOptions{}.target;
  const std::array<double, 2> ball = {1.0, 0.3};
  const auto exact = exact_velocity(ball);
  return {
      .id = "fig4a",
      .title = "Loss over the initial velocity, ball at (1, 0.3)",
      .where = "Fig. 4a",
      .panels = {{.title = "",
                  .x_label = "v1",
                  .y_label = "v2",
                  .series = {mark("start", "bfgs", 1, 0),
                             mark("solution", "solution", exact[0], exact[1])},
                  .field = loss_over_plane(
                      *problems::billiards().make<double>(),
                      {.y = Eigen::Vector2d(target[0], target[1]),
                       .given = Eigen::Vector2d(ball[0], ball[1])},
                      spaced(0, 3, 161),
                      spaced(-1.5, 1, 121))}},
      .columns = 1,
      .note =
          "The even region is the plateau: the cue ball misses or "
          "stops short, and the gradient is exactly zero."};
}

using Place = std::array<double, 2>;

Place place(const Vector<double>& v) { return {v(0), v(1)}; }

/// The other ball stays where it is.
bool first_guess_misses(const Vector<double>& given, const Vector<double>&) {
  return !collide(BilliardsOptions{}.start, place(given)).hit;
}

/// One ball's centre along a straight way with a bend or none; where it starts
/// dashed, where it comes to rest whole.
void add_ball(std::string name,
              PlotStyle style,
              const std::vector<Place>& way,
              Panel& panel) {
  Series line{.label = name, .method = name, .style = style};
  for (const Place& p : way)
    line.x.push_back(few_digits(p[0])), line.y.push_back(few_digits(p[1]));
  for (const Place& p : {way.front(), way.back()}) {
    panel.series.push_back(
        circle("", name, p[0], p[1], BilliardsOptions{}.radius, style));
    panel.series.back().dashed = p == way.front() && way.size() > 1;
  }
  panel.series.push_back(std::move(line));
}

/// Both balls from their start to rest.
Panel shot(const FoundBy& found, const Pictured& problem) {
  const BilliardsOptions o;
  const Place v = place(found.x), ball = place(problem.given);
  const Collision<double> c = collide(v, ball);
  // A ball of velocity u comes to rest u / mu further.
  const auto rest = [&](const Place& from, const Place& u) {
    return Place{from[0] + u[0] / o.drag, from[1] + u[1] / o.drag};
  };
  std::vector<Place> cue = {o.cue}, other = {ball};
  if (c.hit) {
    cue.push_back(c.cue_at_contact);
    cue.push_back(rest(c.cue_at_contact, c.cue_velocity_after));
    other.push_back(c.final_ball);
  } else {
    cue.push_back(rest(o.cue, v));
  }
  const double miss = math::hypot(c.final_ball[0] - problem.y(0),
                                  c.final_ball[1] - problem.y(1));
  Panel panel{.title = fmt::format("{}: {:.2g} off", found.who, miss),
              .y_min = -0.7,
              .y_max = 1.7,
              .x_min = -0.4,
              .x_max = 2.9,
              .space = true};
  if (miss < 1e-3) panel.title = found.who + ": on target";
  add_ball("cue ball", {Hue::blue, Marker::circle}, cue, panel);
  add_ball("other ball", {Hue::orange, Marker::circle}, other, panel);
  panel.series.push_back(mark("target",
                              "target of a shot",
                              problem.y(0),
                              problem.y(1),
                              PlotStyle{Hue::ink, Marker::cross}));
  return panel;
}

PictureOptions shots() {
  return {.title =
              "One shot: the exact one, the first guess, and what each "
              "method plays",
          .note =
              "Circles are the balls, dashed where they start, whole where "
              "they come to rest; the title says how far from the target the "
              "other ball stops.",
          .worth = {first_guess_misses,
                    "whose first guess misses the other ball, where the "
                    "gradient is zero"},
          .draw = shot};
}

Section report(const Evidence& e) {
  const JpoReportOptions options{.unknowns = {"v1", "v2"}, .picture = shots()};
  Section section = jpo_section(options, e);
  section.figures.insert(section.figures.begin(), landscape());
  return section;
}

}  // namespace

void add_reports(Registry& r) { r.add_report("jpo/billiards", report); }

}  // namespace physinv::jpo::billiards
