// Fig. 6 and Figs. 19 to 24 of the JPO paper.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "problems/navier_stokes/navier_stokes.h"
#include "suite/cases/jpo/common/networks.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/harness/registry.h"

namespace physinv {
namespace {

constexpr const char* kName = "jpo/navier-stokes";
const std::vector<std::string> kChains = {"jpo", "supervised", "na"};

/// Speed in the observed half, two by two cells as one.
Panel speed(std::string title, const Vector<double>& y) {
  const NavierStokesOptions o;
  const Index rows = o.cells / 2, plane = o.cells * rows;
  const double width = o.box / double(o.cells);
  const auto at = [&](Index i, Index j) {
    double sum = 0;
    for (const Index k : {i * rows + j,
                          i * rows + j + 1,
                          (i + 1) * rows + j,
                          (i + 1) * rows + j + 1})
      sum += std::hypot(y(k), y(plane + k)) / 4;
    return sum;
  };
  Panel panel{.title = std::move(title), .field = Field2D{.label = "speed"}};
  for (Index i = 0; i < o.cells; i += 2)
    panel.field->x.push_back(double(i + 1) * width);
  for (Index j = 0; j < rows; j += 2) {
    panel.field->y.push_back(o.box / 2 + double(j + 1) * width);
    for (Index i = 0; i < o.cells; i += 2)
      panel.field->values.push_back(at(i, j));
  }
  return panel;
}

/// Fig. 6a, b: what was seen of the first problem, and what estimates make.
Figure pictures(const JpoMetrics& metrics, const Results& results, Index n) {
  Figure figure{.id = "fig6ab",
                .title = "Final flow above the obstacles",
                .source = "Fig. 6b",
                .columns = 3,
                .note =
                    "Speed, first problem of the largest set of seed 0; "
                    "four cells are one here."};
  const CaseRecord* bfgs = results.find_case(kName, "bfgs", n, 0);
  if (bfgs == nullptr || bfgs->data.y.cols() == 0) return figure;
  figure.panels.push_back(speed("observed", bfgs->data.y.col(0)));
  const NavierStokes<double> physics;
  const auto add = [&](const std::string& title, const StageRecord* stage) {
    if (stage == nullptr || stage->x.cols() == 0) return;
    Batch<double> y(bfgs->data.y.rows(), 1);
    Workspace work;
    physics.forward(
        stage->x.leftCols(1), bfgs->data.given.leftCols(1), y, work);
    figure.panels.push_back(speed(title, y.col(0)));
  };
  add("BFGS", metrics.stage("bfgs", n, 0, "solve"));
  for (const auto& method : kChains)
    for (const bool refined : {false, true})
      add(method_title(method) + (refined ? ", refined" : ""),
          metrics.ending(method, n, 0, refined));
  return figure;
}

/// Figs. 19, 20: losses over each true parameter.
Figure over_truth(const JpoMetrics& metrics,
                  const Results& results,
                  Index n,
                  const char* id,
                  const char* source) {
  Figure figure{
      .id = id,
      .title = "Loss over the true parameters, n = " + std::to_string(n),
      .source = source,
      .columns = 3,
      .note = "All seeds; networks without refinement."};
  const char* const names[] = {"x0", "vx", "vy"};
  for (Index j = 0; j < 3; ++j) {
    Panel panel{.x_label = names[j], .y_label = "loss", .y_log = true};
    const auto add = [&](const std::string& method) {
      Series series{.label = method_title(method),
                    .method = method,
                    .line = false,
                    .markers = true};
      for (const std::uint64_t seed : metrics.seeds()) {
        const auto* stage = metrics.ending(method, n, seed, false);
        const auto* found = results.find_case(kName, method, n, seed);
        if (stage == nullptr || found->data.x.cols() != stage->loss.size())
          continue;
        for (Index i = 0; i < stage->loss.size(); ++i) {
          const double z = found->data.x(j, i);
          series.x.push_back(j == 0   ? 50 + 50 * std::tanh(z)
                             : j == 1 ? 5 * z
                                      : 5 + 5 * z);
          series.y.push_back(stage->loss(i));
        }
      }
      if (!series.x.empty()) panel.series.push_back(std::move(series));
    };
    add("bfgs");
    for (const auto& method : kChains) add(method);
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

/// Fig. 6c: curves of one n, gradient descent among them.
Figure curves_with_descent(JpoReportOptions options,
                           const Results& results,
                           const Published& published,
                           Index n) {
  options.methods.insert(options.methods.begin(), "gd");
  options.curves = {"fig6c", "Fig. 6c"};
  options.curve_sizes = {n};
  Figure figure = JpoReport(options, results, published).curves();
  figure.columns = 1;
  return figure;
}

Section report(const Results& results, const Published& published) {
  const JpoReportOptions options{.experiment = kName,
                                 .title = "Incompressible Navier-Stokes",
                                 .paper = "jpo",
                                 .from_prior = true,
                                 .unknowns = {"z0", "z1", "z2"},
                                 .tensors = tensor_names(kName),
                                 .fraction = {"fig6d", "Fig. 6d"},
                                 .improvement = {"fig21", "Fig. 21"},
                                 .curves = {"fig22", "Fig. 22"},
                                 .trajectories = {"fig23", "Fig. 23"},
                                 .weight_change = {"fig24", "Fig. 24"}};
  Section section = jpo_section(options, results, published);
  const JpoMetrics metrics(results, kName);
  const auto sizes = metrics.sizes();
  if (sizes.empty()) return section;
  section.figures.insert(
      section.figures.begin(),
      {pictures(metrics, results, sizes.back()),
       curves_with_descent(options, results, published, sizes.back()),
       over_truth(metrics, results, sizes.front(), "fig19", "Fig. 19")});
  if (sizes.size() > 1)
    section.figures.push_back(
        over_truth(metrics, results, sizes.back(), "fig20", "Fig. 20"));
  return section;
}

const bool kReport = register_report(kName, report);

}  // namespace
}  // namespace physinv
