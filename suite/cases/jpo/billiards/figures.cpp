// Fig. 4a of the JPO paper, beside what all its experiments show.
#include <array>
#include <string>
#include <utility>

#include "problems/billiards/billiards.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/harness/registry.h"

namespace physinv::jpo::billiards {
namespace {

/// Fig. 4a: the loss over the cue ball's velocity, for one position.
Figure landscape() {
  const Billiards<double> billiards;
  const std::array<double, 2> ball = {1.0, 0.3};
  constexpr Index kColumns = 161, kRows = 121;
  Field2D field{
      .x = {}, .y = {}, .values = {}, .log_scale = true, .label = "loss"};
  for (Index i = 0; i < kColumns; ++i)
    field.x.push_back(3.0 * static_cast<double>(i) / (kColumns - 1));
  for (Index j = 0; j < kRows; ++j)
    field.y.push_back(-1.5 + 2.5 * static_cast<double>(j) / (kRows - 1));
  const Index n = kColumns * kRows;
  Batch<double> v(2, n), given(2, n), y(2, n), target(2, n);
  given.colwise() = Eigen::Vector2d(ball[0], ball[1]);
  target.colwise() = Eigen::Vector2d(billiards.options().target[0],
                                     billiards.options().target[1]);
  for (Index i = 0; i < n; ++i) {
    v(0, i) = field.x[static_cast<std::size_t>(i % kColumns)];
    v(1, i) = field.y[static_cast<std::size_t>(i / kColumns)];
  }
  Vector<double> loss(n);
  Workspace work;
  billiards.forward(v, given, y, work);
  billiards.loss(y, target, loss);
  field.values.assign(loss.begin(), loss.end());

  const auto exact = exact_velocity(ball);
  const auto mark =
      [](std::string label, std::string method, double x, double at) {
        return Series{.label = std::move(label),
                      .method = std::move(method),
                      .x = {x},
                      .y = {at},
                      .line = false,
                      .markers = true};
      };
  return {
      .id = "fig4a",
      .title = "Loss over the initial velocity, ball at (1, 0.3)",
      .source = "Fig. 4a",
      .panels = {{.title = "",
                  .x_label = "v1",
                  .y_label = "v2",
                  .series = {mark("start", "bfgs", 1, 0),
                             mark("solution", "solution", exact[0], exact[1])},
                  .field = std::move(field)}},
      .columns = 1,
      .note =
          "The even region is the plateau: the cue ball misses or "
          "stops short, and the gradient is exactly zero."};
}

Section report(const Results& results, const Published& published) {
  const JpoReportOptions options{
      .experiment = "jpo/billiards",
      .title = "Billiards",
      .paper = "jpo",
      .unknowns = {"v1", "v2"},
      .tensors = {"m1", "b1", "m2", "b2", "m3", "b3", "m4", "b4"}};
  Section section = jpo_section(options, results, published);
  section.figures.insert(section.figures.begin(), landscape());
  return section;
}

}  // namespace

void add_reports(Registry& r) { r.add_report("jpo/billiards", report); }

}  // namespace physinv::jpo::billiards
