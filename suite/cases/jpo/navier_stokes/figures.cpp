// Fig. 6 and Figs. 19 to 24 of the JPO paper.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "problems/navier_stokes/navier_stokes.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/core/any_problem.h"
#include "suite/core/math.h"
#include "suite/evidence/field_panel.h"
#include "suite/evidence/method_titles.h"
#include "suite/harness/networks.h"
#include "suite/harness/registry.h"
#include "suite/harness/study.h"

namespace physinv::jpo::navier_stokes {
namespace {

constexpr const char* kName = "jpo/navier-stokes";
const std::vector<std::string> kChains = {"jpo", "supervised", "na"};

/// A flow (u, v) from row `below` on; obstacles are blank.
Panel blank_at_obstacles(std::string title,
                         const Vector<double>& uv,
                         Index below) {
  const NavierStokesOptions o;
  const Index rows = o.cells - below, part = o.cells * rows;
  const double width = o.box / double(o.cells);
  const FieldLayout layout{
      o.cells, rows, rows, 1, width, 0, double(below) * width};
  Vector<double> u = uv.head(part), v = uv.tail(part);
  for (const fluid::Obstacle& b : o.obstacles)
    for (Index i = b.i0; i < b.i1; ++i)
      for (Index j = std::max(b.j0, below); j < b.j1; ++j)
        u(i * rows + j - below) = std::nan("");
  return flow_panel(std::move(title), layout, u, v, 4);
}

/// The observed half.
Panel observed(std::string title, const Vector<double>& y) {
  return blank_at_obstacles(
      std::move(title), y, NavierStokesOptions{}.cells / 2);
}

/// x0, vx, vy of one z.
std::array<double, 3> blast(const Vector<double>& z) {
  const NavierStokesOptions o;
  return {
      o.box / 2 * (1 + math::tanh(z(0))), o.speed * z(1), o.speed * (1 + z(2))};
}

/// Fig. 6a: the first problem at t = 0, what is hidden and the blast, too.
Figure at_the_start(const CaseRecord& first) {
  const NavierStokesOptions o;
  const AnyProblem<double> physics(problems::navier_stokes(o));
  const auto shown = physics.sample_labelled(
      0, 1, root_of(kName, first.info.seed).child("data/test"));
  const auto [x0, vx, vy] = blast(first.data.x.col(0));
  Vector<double> uv = shown.given.col(0);
  const double size = o.box / double(o.cells);
  const Index all = o.cells * o.cells;
  for (Index i = 0; i < o.cells; ++i)
    for (Index j = 0; j < o.cells; ++j) {
      const double x = (double(i) + 0.5) * size - x0,
                   y = (double(j) + 0.5) * size - o.height;
      const double wind = math::exp(-(x * x + y * y) / (2 * o.width * o.width));
      uv(i * o.cells + j) += wind * vx;
      uv(all + i * o.cells + j) += wind * vy;
    }
  return {.id = "fig6a",
          .title = "Initial flow with the true blast",
          .where = "Fig. 6a",
          .panels = {blank_at_obstacles("t = 0", uv, 0)},
          .columns = 1,
          .note =
              "Speed, first problem of seed 0; obstacles are blank. Methods "
              "are given the upper half, without the blast."};
}

/// Estimates of the first problem of seed 0, truth first.
struct Said {
  std::string who;
  Batch<double> x;
};
Batch<double> first_guess() {
  return problems::navier_stokes().make<double>()->start();
}
std::vector<Said> said(const Evidence& e, const CaseRecord& first, Index n) {
  std::vector<Said> all = {{"truth", first.data.x.leftCols(1)},
                           {"start", first_guess()}};
  const auto add = [&](const std::string& who, const Select& runs) {
    for (const Run& run : find_runs(e, at(runs, n)))
      if (run.seed() == 0 && run.stage->x.cols() > 0)
        all.push_back({who, run.stage->x.leftCols(1)});
  };
  add("BFGS", bfgs());
  for (const auto& method : kChains)
    for (const bool is_refined : {false, true})
      add(method_title(method) + (is_refined ? ", refined" : ""),
          ending(method, is_refined));
  return all;
}

/// What an estimate makes of the flow that was given, after so many steps.
Vector<double> blown(const Batch<double>& x,
                     const Batch<double>& given,
                     Index steps) {
  NavierStokesOptions o;
  o.end_time *= double(steps) / double(o.steps);
  o.steps = steps;
  const AnyProblem<double> physics(problems::navier_stokes(o));
  Batch<double> y(physics.shape().observations, 1);
  Workspace work;
  physics.forward(x, given, y, work);
  return y;
}

/// Fig. 6b: what was seen of the first problem, and what estimates make.
Figure pictures(const CaseRecord& first, const std::vector<Said>& all) {
  Figure figure{.id = "fig6b",
                .title = "Final flow above the obstacles",
                .where = "Fig. 6b",
                .columns = 3,
                .note =
                    "Speed, first problem of the largest set of seed 0. "
                    "The truth blows into the flow that is given, whose "
                    "lower half is hidden.",
                .picture = true};
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
  std::erase_if(all, [](const Said& s) {
    return s.who == "start" || s.who.ends_with("refined");
  });
  Figure figure{.id = "film",
                .title = "The blast on its way",
                .where = "Fig. 6b",
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

/// One row of panels of Figs. 19 and 20: losses over each true parameter, and
/// how they are distributed.
class OverTruth {
 public:
  OverTruth(const Evidence& evidence, Index n) : evidence_(evidence), n_(n) {}

  void add_row(bool refined, std::vector<Panel>& panels) const {
    const std::string which = refined ? "refined" : "networks alone";
    const char* const names[] = {"x0", "vx", "vy"};
    for (std::size_t j = 0; j < 3; ++j) {
      Panel panel{.title = which,
                  .x_label = names[j],
                  .y_label = "loss",
                  .y_log = true};
      for (const auto& method : shown())
        add(series(method,
                   refined,
                   [&](const Vector<double>& z) { return blast(z)[j]; }),
            panel);
      panels.push_back(std::move(panel));
    }
    Panel panel{.title = which,
                .x_label = "share of problems with a lower loss",
                .y_label = "loss",
                .y_log = true};
    for (const auto& method : shown()) {
      Series sorted =
          series(method, refined, [](const Vector<double>&) { return 0.0; });
      std::sort(sorted.y.begin(), sorted.y.end());
      for (std::size_t i = 0; i < sorted.x.size(); ++i)
        sorted.x[i] = (double(i) + 0.5) / double(sorted.x.size());
      sorted.line = true, sorted.markers = false;
      add(std::move(sorted), panel);
    }
    panels.push_back(std::move(panel));
  }

 private:
  static std::vector<std::string> shown() {
    std::vector<std::string> all = {"bfgs"};
    all.insert(all.end(), kChains.begin(), kChains.end());
    return all;
  }
  static void add(Series series, Panel& panel) {
    if (!series.x.empty()) panel.series.push_back(std::move(series));
  }

  /// Of all seeds, where(z) to the right.
  template <class F>
  Series series(const std::string& method, bool refined, F where) const {
    Series out{.label = method_title(method),
               .method = method,
               .line = false,
               .markers = true};
    for (const Run& run :
         find_runs(evidence_, at(ending(method, refined), n_))) {
      const Batch<double>& truth = run.record->data.x;
      if (truth.cols() != run.stage->loss.size()) continue;
      for (Index i = 0; i < truth.cols(); ++i) {
        out.x.push_back(where(truth.col(i)));
        out.y.push_back(run.stage->loss(i));
      }
    }
    return out;
  }

  const Evidence& evidence_;
  Index n_;
};

/// Figs. 19, 20.
Figure over_truth(const Evidence& evidence,
                  Index n,
                  const char* id,
                  const char* where) {
  Figure figure{
      .id = id,
      .title = "Loss over the true parameters, n = " + std::to_string(n),
      .where = where,
      .columns = 4,
      .note = "All seeds; BFGS is the same in both rows."};
  const OverTruth rows(evidence, n);
  for (const bool refined : {false, true}) rows.add_row(refined, figure.panels);
  return figure;
}

Section report(const Evidence& e) {
  const JpoReportOptions options{.from_prior = true,
                                 .unknowns = {"z0", "z1", "z2"},
                                 .fraction = {"fig6d", "Fig. 6d"},
                                 .improvement = {"fig21", "Fig. 21"},
                                 .curves = {"fig22", "Fig. 22"},
                                 .trajectories = {"fig23", "Fig. 23"},
                                 .weight_change = {"fig24", "Fig. 24"}};
  Section section = jpo_section(options, e);
  const auto sizes = e.results.sizes(kName);
  if (sizes.empty()) return section;
  std::vector<Figure> before = {
      curves_with_descent(options, {"fig6c", "Fig. 6c"}, e),
      over_truth(e, sizes.front(), "fig19", "Fig. 19")};
  const CaseRecord* first = e.results.find_case(kName, "bfgs", sizes.back(), 0);
  if (first != nullptr && first->data.y.cols() > 0) {
    const auto all = said(e, *first, sizes.back());
    before.insert(
        before.begin(),
        {at_the_start(*first), pictures(*first, all), film(*first, all)});
  }
  section.figures.insert(section.figures.begin(), before.begin(), before.end());
  if (sizes.size() > 1)
    section.figures.push_back(over_truth(e, sizes.back(), "fig20", "Fig. 20"));
  return section;
}

}  // namespace

void add_reports(Registry& r) { r.add_report(kName, report); }

}  // namespace physinv::jpo::navier_stokes
