// Fig. 4a of the JPO paper, beside what all its experiments show.
#include <array>

#include "problems/billiards/billiards.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/evidence/landscape.h"
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

Section report(const Evidence& e) {
  const JpoReportOptions options{.unknowns = {"v1", "v2"}};
  Section section = jpo_section(options, e);
  section.figures.insert(section.figures.begin(), landscape());
  return section;
}

}  // namespace

void add_reports(Registry& r) { r.add_report("jpo/billiards", report); }

}  // namespace physinv::jpo::billiards
