// Fig. 6 and Figs. 19 to 24 of the JPO paper.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "problems/navier_stokes/navier_stokes.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/evidence/plane.h"
#include "suite/harness/networks.h"
#include "suite/harness/registry.h"

namespace physinv::jpo::navier_stokes {
namespace {

constexpr const char* kName = "jpo/navier-stokes";
const std::vector<std::string> kChains = {"jpo", "supervised", "na"};

/// The observed half of a flow; obstacles are blank.
Panel observed(std::string title, const Vector<double>& y) {
  const NavierStokesOptions o;
  const Index below = o.cells / 2, rows = o.cells - below;
  const double width = o.box / double(o.cells);
  const PlaneLayout layout{
      o.cells, rows, rows, 1, width, 0, double(below) * width};
  const Index half = o.cells * rows;
  Vector<double> u = y.head(half), v = y.tail(half);
  for (const fluid::Obstacle& b : o.obstacles)
    for (Index i = b.i0; i < b.i1; ++i)
      for (Index j = std::max(b.j0, below); j < b.j1; ++j)
        u(i * rows + j - below) = std::nan("");
  return flow(std::move(title), layout, u, v, 4);
}

/// Estimates of the first problem of seed 0, truth first.
struct Said {
  std::string who;
  Batch<double> x;
};
std::vector<Said> said(const JpoMetrics& metrics,
                       const CaseRecord& first,
                       Index n) {
  std::vector<Said> all = {{"truth", first.data.x.leftCols(1)}};
  const auto add = [&](const std::string& who, const StageRecord* stage) {
    if (stage != nullptr && stage->x.cols() > 0)
      all.push_back({who, stage->x.leftCols(1)});
  };
  add("BFGS", metrics.stage("bfgs", n, 0, "solve"));
  for (const auto& method : kChains)
    for (const bool refined : {false, true})
      add(method_title(method) + (refined ? ", refined" : ""),
          metrics.ending(method, n, 0, refined));
  return all;
}

/// What an estimate makes of the flow that was given, after so many steps.
Vector<double> blown(const Batch<double>& x,
                     const Batch<double>& given,
                     Index steps) {
  NavierStokesOptions o;
  o.end_time *= double(steps) / double(o.steps);
  o.steps = steps;
  const NavierStokes<double> physics(o);
  Batch<double> y(physics.shape().observations, 1);
  Workspace work;
  physics.forward(x, given, y, work);
  return y;
}

/// Fig. 6a, b: what was seen of the first problem, and what estimates make.
Figure pictures(const CaseRecord& first, const std::vector<Said>& all) {
  Figure figure{.id = "fig6ab",
                .title = "Final flow above the obstacles",
                .source = "Fig. 6b",
                .columns = 3,
                .note =
                    "Speed, first problem of the largest set of seed 0. "
                    "The truth blows into the flow that is given, whose "
                    "lower half is hidden."};
  figure.panels.push_back(observed("observed", first.data.y.col(0)));
  const Index steps = NavierStokesOptions{}.steps;
  for (const auto& [who, x] : all)
    figure.panels.push_back(
        observed(who, blown(x, first.data.given.leftCols(1), steps)));
  share_scale(figure.panels);
  return figure;
}

/// The same on its way, for the networks' unrefined answers.
Figure film(const CaseRecord& first, std::vector<Said> all) {
  std::erase_if(all, [](const Said& s) { return s.who.ends_with("refined"); });
  Figure figure{.id = "film",
                .title = "The blast on its way",
                .source = "Fig. 6b",
                .columns = 3,
                .note = "Every fourth step.",
                .moment = int(all.size())};
  for (Index steps = 4; steps <= NavierStokesOptions{}.steps; steps += 4)
    for (const auto& [who, x] : all)
      figure.panels.push_back(
          observed(who + ", step " + std::to_string(steps),
                   blown(x, first.data.given.leftCols(1), steps)));
  share_scale(figure.panels);
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
  std::vector<Figure> before = {
      curves_with_descent(options, results, published, sizes.back()),
      over_truth(metrics, results, sizes.front(), "fig19", "Fig. 19")};
  const CaseRecord* first = results.find_case(kName, "bfgs", sizes.back(), 0);
  if (first != nullptr && first->data.y.cols() > 0) {
    const auto all = said(metrics, *first, sizes.back());
    before.insert(before.begin(), {pictures(*first, all), film(*first, all)});
  }
  section.figures.insert(section.figures.begin(), before.begin(), before.end());
  if (sizes.size() > 1)
    section.figures.push_back(
        over_truth(metrics, results, sizes.back(), "fig20", "Fig. 20"));
  return section;
}

const bool kReport = register_report(kName, report);

}  // namespace
}  // namespace physinv::jpo::navier_stokes
