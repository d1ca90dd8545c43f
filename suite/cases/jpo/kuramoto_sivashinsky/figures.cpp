// Fig. 5 and the numbers in the text of the JPO paper, in addition to what all
// its experiments show.
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/cases/jpo/common/values.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/landscape.h"
#include "suite/evidence/picture.h"
#include "suite/evidence/series.h"
#include "suite/harness/networks.h"
#include "suite/harness/registry.h"

namespace physinv::jpo::kuramoto_sivashinsky {
namespace {

constexpr const char* kName = "jpo/kuramoto-sivashinsky";
const Solved kNear = within_of_truth(1e-3);

/// The first problem of seed 0.
Samples<double> example(const Problem<double>& physics) {
  return physics.sample(0, 1, Rng::root(kName, 0).child("data/test"));
}

/// u(x, t), of each so many steps and cells one.
Field2D evolution(const Vector<double>& x,
                  const Vector<double>& given,
                  Index every = 1) {
  const KuramotoSivashinskyOptions options;
  const Batch<double> u =
      kuramoto_sivashinsky_trajectory<double>(options, x, given);
  Field2D field;
  for (Index k = 0; k < u.cols(); k += every)
    field.x.push_back(static_cast<double>(k) * options.time_step);
  for (Index j = 0; j < u.rows(); j += every) {
    field.y.push_back((static_cast<double>(j) + 0.5) * options.box /
                      static_cast<double>(options.cells));
    for (Index k = 0; k < u.cols(); k += every) field.values.push_back(u(j, k));
  }
  return field;
}

/// What alpha and beta make of the first state.
Panel run_from(const FoundBy& found, const Pictured& problem) {
  Panel panel{.title = fmt::format(
                  "{}: α {:.4g}, β {:.4g}", found.who, found.x(0), found.x(1)),
              .x_label = "t",
              .y_label = "x",
              .field = evolution(found.x, problem.given, 2)};
  for (double& u : panel.field->values) u = few_digits(u);
  return panel;
}

PictureOptions evolutions() {
  return {.title =
              "u(x, t) with the true forcing α and advection β, the "
              "first guess, and what each method finds",
          .note =
              "All begin with the same state; methods are given its end "
              "with the true values, at t = 25.",
          .draw = run_from};
}

/// Fig. 5a: one trajectory.
Figure trajectory() {
  const Samples<double> s =
      example(*problems::kuramoto_sivashinsky().make<double>());
  Field2D field = evolution(s.x.col(0), s.given.col(0));
  field.label = "u";
  return {
      .id = "fig5a",
      .title = "A trajectory u(x, t)",
      .where = "Fig. 5a",
      .panels = {{.x_label = "t", .y_label = "x", .field = std::move(field)}},
      .columns = 1,
      .note = fmt::format("Problem 0 of seed 0: alpha = {:.3f}, beta = "
                          "{:.3f}.",
                          s.x(0, 0),
                          s.x(1, 0))};
}

/// Fig. 5b: the loss over beta at the true alpha.
Figure landscape() {
  const auto physics = problems::kuramoto_sivashinsky().make<double>();
  const Samples<double> s = example(*physics);
  Batch<double> x(2, 401);
  x.row(0).setConstant(s.x(0, 0));
  x.row(1).setLinSpaced(0.5, 1.5);
  Panel panel =
      line_panel("bfgs",
                 "beta",
                 "loss",
                 x.row(1),
                 losses_of(*physics, {s.y.col(0), s.given.col(0)}, x));
  panel.series.push_back(mark("solution", "truth", s.x(1, 0), 0));
  return {
      .id = "fig5b",
      .title = "Loss over beta at the true alpha",
      .where = "Fig. 5b",
      .panels = {std::move(panel)},
      .columns = 1,
      .note = fmt::format("Problem 0 of seed 0, alpha = {:.3f}.", s.x(0, 0))};
}

struct PrintedNumber {
  const char *label, *printed;
  Quantity ours;
};

/// Numbers of Sec. 4 and App. D.3 that are in no table.
std::vector<PrintedNumber> printed_numbers() {
  const auto solved = [](const Select& runs) {
    return percent(
        share_of_examples(runs.of_sizes(32), if_solved(kNear), holds));
  };
  const RunValue mean_iterations = of_row(iterations(), mean_of);
  const Select bfgs = jpo::bfgs();
  return {{"BFGS solves, n >= 32, %", "bfgs/solved", solved(bfgs)},
          {"JPO refined solves, n >= 32, %", "jpo/solved", solved(kRefined)},
          {"BFGS iterations, lowest",
           "bfgs/iterations_low",
           lowest_mean(bfgs, mean_iterations)},
          {"BFGS iterations, highest",
           "bfgs/iterations_high",
           highest_mean(bfgs, mean_iterations)},
          {"refinement iterations, lowest",
           "jpo/iterations_low",
           lowest_mean(kRefined, mean_iterations)},
          {"refinement iterations, highest",
           "jpo/iterations_high",
           highest_mean(kRefined, mean_iterations)},
          {"JPO refined better, n = 256, %",
           "jpo/better/n=256",
           percent_better(at(kRefined, 256))},
          {"supervised refined better, %",
           "supervised/refined",
           percent_better(kSupervisedRefined)},
          {"supervised refined better, n = 2, %",
           "supervised/refined/n=2",
           percent_better(at(kSupervisedRefined, 2))},
          {"supervised refined better, n >= 64, %",
           "supervised/refined/n>=64",
           percent_better(kSupervisedRefined.of_sizes(64))},
          {"supervised better, n = 2, %",
           "supervised/better/n=2",
           percent_better(at(kSupervised, 2))},
          {"supervised better, n >= 64, %",
           "supervised/better/n>=64",
           percent_better(kSupervised.of_sizes(64))}};
}

Table numbers_of_text(const Evidence& evidence) {
  Table table{.id = "text",
              .title = "Numbers of the text",
              .where = "Sec. 4, App. D.3",
              .digits = 1,
              .columns = {"value"},
              .note =
                  "Solved: both unknowns within 1e-3. Iterations: lowest and "
                  "highest mean of any n. Better: than BFGS."};
  for (const auto& [label, name, ours] : printed_numbers()) {
    table.rows.push_back({label,
                          {beside_printed(cell_of(ours(evidence).value),
                                          evidence,
                                          std::string("text/") + name)}});
  }
  return table;
}

Section report(const Evidence& e) {
  const JpoReportOptions options{.solved = kNear,
                                 .trajectory_size = 128,
                                 .unknowns = {"alpha", "beta"},
                                 .fraction = {"fig5d", "Fig. 5d"},
                                 .improvement = {"fig15", "Fig. 15"},
                                 .curves = {"fig16", "Fig. 16"},
                                 .trajectories = {"fig17", "Fig. 17"},
                                 .weight_change = {"fig18", "Fig. 18"},
                                 .picture = evolutions()};
  Section section = jpo_section(options, e);
  section.figures.insert(
      section.figures.begin(),
      {trajectory(),
       landscape(),
       curves_with_descent(options, {"fig5c", "Fig. 5c"}, e)});
  section.tables.push_back(numbers_of_text(e));
  return section;
}

}  // namespace

void add_reports(Registry& r) { r.add_report(kName, report); }

}  // namespace physinv::jpo::kuramoto_sivashinsky
