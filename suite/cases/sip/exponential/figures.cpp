#include <algorithm>
#include <vector>

#include "suite/cases/sip/exponential/metrics.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"

namespace physinv::exponential {
namespace {

const std::vector<MethodLine> kLines = {
    {"sgd", "SGD", Hue::blue},
    {"adam", "Adam", Hue::purple},
    {"norm", "Adam, sign of the inverse's step", Hue::orange},
    {"gt", "Adam, the inverse's step", Hue::green},
    {"adahessian", "AdaHessian", Hue::olive},
    {"hf", "Hessian-free", Hue::indigo},
    {"newton", "Adam, Newton's step", Hue::teal},
    {"newton-clipped", "at most 0.1", Hue::pink},
    {"newton-damped", "Hessian + 0.01", Hue::brown}};

/// What the networks of the first seed answer, over the whole range.
Figure predictions(const Evidence& e) {
  Panel panel{.x_label = "x*", .y_label = "x"};
  for (const MethodLine& line : kLines) {
    const auto chains = trained_chains(e, line.method);
    if (chains.empty()) continue;
    const auto& truth = chains.front()->data.x;
    const auto& x = chains.front()->stages.back().x;
    std::vector<std::pair<double, double>> points;
    for (Index i = 0; i < std::min(truth.cols(), x.cols()); ++i)
      points.emplace_back(truth(0, i), x(0, i));
    std::sort(points.begin(), points.end());
    Series s = series_of(line);
    for (const auto& [wanted, answer] : points)
      s.x.push_back(wanted), s.y.push_back(answer);
    panel.series.push_back(std::move(s));
  }
  if (!panel.series.empty())
    panel.series.push_back({.label = "x = x*",
                            .method = "truth",
                            .x = {-12, 0},
                            .y = {-12, 0},
                            .dashed = true,
                            .style = PlotStyle{.hue = Hue::ink}});
  return {.id = "fig2",
          .title = "Predictions after training",
          .where = "Fig. 2",
          .panels = {std::move(panel)},
          .columns = 1,
          .note = "Networks of the first seed on the test set.",
          .picture = true};
}

Section report(const Evidence& e) {
  Section section{.tables = {loss_table(e, kLines)},
                  .figures = {predictions(e)},
                  .method_titles = titles_of(kLines)};
  LearningCurves curves(e, section);
  curves.metric(kLines, kMean, "mean |x - x*|", "errors", "Errors of x", "");
  curves.losses(kLines, "losses", "Learning curves", "");
  return section;
}

}  // namespace

void add_reports(Registry& r) { r.add_report("sip/exponential", report); }

}  // namespace physinv::exponential
