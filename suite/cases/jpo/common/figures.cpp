#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "suite/cases/jpo/common/report.h"
#include "suite/evidence/guests.h"
#include "suite/evidence/method_titles.h"
#include "suite/evidence/series.h"
#include "suite/evidence/statistics.h"
#include "suite/harness/networks.h"

namespace physinv {
namespace {

constexpr Index kExamples = 4;

// Mean and, if there is one, mean -+ deviation.
void append_means(Series& s, double x, const std::vector<double>& values) {
  const auto found = mean_std(values);
  if (!found) return;
  const double spread = found->std.value_or(0);
  s.x.push_back(x);
  s.y.push_back(found->mean);
  s.lo.push_back(found->mean - spread);
  s.hi.push_back(found->mean + spread);
}

// Median and 10 % and 90 % quantiles, for logarithmic axes.
void append_quantiles(Series& s, double x, const std::vector<double>& values) {
  if (values.empty()) return;
  s.x.push_back(x);
  s.y.push_back(median(values));
  s.lo.push_back(quantile(values, 0.1));
  s.hi.push_back(quantile(values, 0.9));
}

// Mean loss at the last measured point up to an iteration: a run that ended
// stays where it is while runs of other seeds continue.
std::optional<double> loss_at(const Curve& curve, double iteration) {
  const auto after = std::upper_bound(
      curve.iteration.begin(), curve.iteration.end(), iteration);
  if (after == curve.iteration.begin()) return {};
  return curve.loss.col(after - curve.iteration.begin() - 1).mean();
}

bool tracks(const StageRecord& stage, Index example) {
  return stage.curve.points() > 0 &&
         (example + 1) * stage.x.rows() <= stage.curve.x.rows();
}

std::vector<double> tracked(const StageRecord& stage, Index example, Index j) {
  const auto row = stage.curve.x.row(example * stage.x.rows() + j);
  return {row.begin(), row.end()};
}

std::vector<double> plus_one(std::vector<double> iterations) {
  for (double& i : iterations) i += 1;
  return iterations;
}

}  // namespace

std::vector<double> JpoReport::values(const Select& runs,
                                      Index n,
                                      const RunValue& value) const {
  return values_of(sample(evidence_, jpo::at(runs, n), value));
}

Series JpoReport::over_n(std::string label,
                         std::string method,
                         const Select& runs,
                         const RunValue& value,
                         Over over) const {
  Series s{
      .label = std::move(label), .method = std::move(method), .markers = true};
  for (const Index n : sizes())
    (over == Over::means ? append_means : append_quantiles)(
        s, static_cast<double>(n), values(runs, n, value));
  return s;
}

Series JpoReport::f_series(const std::string& method, bool refined) const {
  return over_n(
      method_title(method), method, ending(method, refined), jpo::f());
}

Series JpoReport::loss_series(const std::string& method, bool refined) const {
  return over_n(method_title(method),
                method,
                ending(method, refined),
                jpo::mean_loss(),
                Over::quantiles);
}

// BFGS against itself is equal everywhere: f_N = 1/2.
Series JpoReport::reference_half() const {
  Series s{.label = "as good as BFGS", .method = "bfgs", .dashed = true};
  for (const Index n : sizes()) {
    s.x.push_back(static_cast<double>(n));
    s.y.push_back(0.5);
  }
  return s;
}

Figure JpoReport::fraction() const {
  Panel panel{.x_label = "number of problems n",
              .y_label = "f_N",
              .x_log = true,
              .y_min = 0,
              .y_max = 1};
  panel.series.push_back(reference_half());
  panel.series.push_back(f_series("jpo", false));
  panel.series.push_back(f_series("jpo", true));
  panel.series.back().label += " refined";
  panel.series.back().dashed = true;
  panel.series.push_back(f_series("gd", false));
  for (const auto& method : guests(evidence_))
    panel.series.push_back(f_series(method, false));
  return {.id = options_.fraction.id,
          .title = title() + ": improvement over BFGS",
          .where = options_.fraction.where,
          .panels = {std::move(panel)},
          .columns = 1,
          .note =
              "f_N = share of problems solved better than by BFGS plus "
              "half the share solved equally well (bit by bit). Bars: "
              "sample standard deviation over seeds."};
}

Figure JpoReport::improvement() const {
  Figure figure{
      .id = options_.improvement.id,
      .title = title() + ": loss and improvement before and after refinement",
      .where = options_.improvement.where,
      .note =
          "Losses: mean over problems, median and 10 % and 90 % "
          "quantiles over seeds. Improvement: mean and sample "
          "standard deviation over seeds."};
  for (const bool refined : {false, true}) {
    Panel panel{
        .title = refined ? "Loss after refinement" : "Loss before refinement",
        .x_label = "n",
        .y_label = "mean loss",
        .x_log = true,
        .y_log = true};
    for (const auto& method : drawn()) {
      panel.series.push_back(loss_series(method, refined));
    }
    figure.panels.push_back(std::move(panel));
  }
  for (const bool refined : {false, true}) {
    Panel panel{.title = refined ? "Improvement after refinement"
                                 : "Improvement before refinement",
                .x_label = "n",
                .y_label = "f_N",
                .x_log = true,
                .y_min = 0,
                .y_max = 1};
    panel.series.push_back(reference_half());
    for (const auto& method : drawn())
      if (method != "bfgs") panel.series.push_back(f_series(method, refined));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

std::vector<Index> JpoReport::sizes_of_curves() const {
  if (!options_.curve_sizes.empty()) return options_.curve_sizes;
  const auto all = sizes();
  if (all.size() <= 4) return all;
  std::vector<Index> four;
  for (std::size_t k = 0; k < 4; ++k) {
    four.push_back(all[k * (all.size() - 1) / 3]);
  }
  return four;
}

Series JpoReport::curve_series(const std::string& method, Index n) const {
  std::vector<const Curve*> curves;
  std::set<double> iterations;
  for (const Run& run :
       find_runs(evidence_, jpo::at(ending(method, false), n))) {
    const Curve& curve = run.stage->curve;
    if (curve.points() == 0) continue;
    curves.push_back(&curve);
    iterations.insert(curve.iteration.begin(), curve.iteration.end());
  }
  Series s{.label = method_title(method), .method = method};
  for (const double iteration : iterations) {
    std::vector<double> values;
    for (const Curve* curve : curves) {
      if (const auto one = loss_at(*curve, iteration)) values.push_back(*one);
    }
    append_quantiles(s, iteration + 1, values);
  }
  return s;
}

Figure JpoReport::curves() const {
  Figure figure{
      .id = options_.curves.id,
      .title = title() + ": optimization curves before refinement",
      .where = options_.curves.where,
      .note =
          "Mean over problems, median over seeds, band: 10 % and 90 % "
          "quantiles. The start is drawn at 1. Curves of BFGS end when "
          "every problem has."};
  for (const Index n : sizes_of_curves()) {
    Panel panel{.title = fmt::format("n = {}", n),
                .x_label = "iteration + 1",
                .y_label = "mean loss",
                .x_log = true,
                .y_log = true};
    for (const auto& method : drawn()) {
      panel.series.push_back(curve_series(method, n));
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

std::string JpoReport::unknown_name(Index j) const {
  const auto k = static_cast<std::size_t>(j);
  return k < options_.unknowns.size() ? options_.unknowns[k]
                                      : fmt::format("unknown {}", j + 1);
}

const StageRecord* JpoReport::of_first_seed(const std::string& method,
                                            Index n) const {
  const auto seed = evidence_.results.seeds(evidence_.experiment).front();
  for (const Run& run : find_runs(evidence_, jpo::at(ending(method, false), n)))
    if (run.seed() == seed) return run.stage;
  return nullptr;
}

std::optional<double> JpoReport::solution_of(Index n,
                                             Index example,
                                             Index j) const {
  const Results& results = evidence_.results;
  const auto seed = results.seeds(evidence_.experiment).front();
  for (const auto& method : with_bfgs()) {
    const auto* found =
        results.find_case(evidence_.experiment, method, n, seed);
    if (found == nullptr) continue;
    const Batch<double> x =
        options_.solution ? options_.solution(*found) : found->data.x;
    if (j < x.rows() && example < x.cols()) return x(j, example);
  }
  return {};
}

Panel JpoReport::plane(Index n, Index example) const {
  Panel panel{.title = fmt::format("Problem {}", example),
              .x_label = unknown_name(0),
              .y_label = unknown_name(1)};
  for (const auto& method : drawn()) {
    const StageRecord* stage = of_first_seed(method, n);
    if (stage == nullptr || !tracks(*stage, example)) continue;
    Series way{.label = method_title(method),
               .method = method,
               .x = tracked(*stage, example, 0),
               .y = tracked(*stage, example, 1)};
    Series end = mark("", method, way.x.back(), way.y.back());
    panel.series.push_back(std::move(way));
    panel.series.push_back(std::move(end));
  }
  const auto x = solution_of(n, example, 0), y = solution_of(n, example, 1);
  if (x && y) panel.series.push_back(mark("solution", "truth", *x, *y));
  return panel;
}

Panel JpoReport::over_iterations(Index n, Index example, Index unknown) const {
  Panel panel{.title = fmt::format("Problem {}", example),
              .x_label = "iteration + 1",
              .y_label = unknown_name(unknown),
              .x_log = true};
  double last = 1;
  for (const auto& method : drawn()) {
    const StageRecord* stage = of_first_seed(method, n);
    if (stage == nullptr || !tracks(*stage, example)) continue;
    panel.series.push_back({.label = method_title(method),
                            .method = method,
                            .x = plus_one(stage->curve.iteration),
                            .y = tracked(*stage, example, unknown)});
    last = std::max(last, panel.series.back().x.back());
  }
  if (const auto x = solution_of(n, example, unknown))
    panel.series.push_back(level("solution", "truth", 1, last, *x));
  return panel;
}

Index JpoReport::size_of_trajectories() const {
  const auto all = sizes();
  const Index asked = options_.trajectory_size;
  return std::count(all.begin(), all.end(), asked) > 0 ? asked : largest_size();
}

Figure JpoReport::trajectories() const {
  Figure figure{.id = options_.trajectories.id,
                .title = title() + ": estimates during optimization",
                .where = options_.trajectories.where};
  const auto seeds = evidence_.results.seeds(evidence_.experiment);
  const Index n = size_of_trajectories();
  if (n == 0 || seeds.empty()) return figure;
  Index unknowns = 0, examples = kExamples;
  for (const auto& method : with_bfgs()) {
    if (const auto* s = of_first_seed(method, n)) {
      unknowns = s->x.rows();
      examples = std::min(examples, s->x.cols());
    }
  }
  if (unknowns == 0) return figure;
  figure.note =
      fmt::format("n = {}, seed {}. Markers: last estimate.", n, seeds.front());
  for (Index e = 0; e < examples; ++e) {
    if (unknowns == 2) {
      figure.panels.push_back(plane(n, e));
      continue;
    }
    for (Index j = 0; j < unknowns; ++j) {
      figure.panels.push_back(over_iterations(n, e, j));
    }
  }
  if (unknowns != 2) {
    figure.columns = static_cast<int>(std::clamp<Index>(unknowns, 2, 4));
    figure.note = fmt::format("n = {}, seed {}.", n, seeds.front());
  }
  return figure;
}

Panel JpoReport::tensor_panel(const std::string& which,
                              const std::vector<std::string>& names,
                              const std::vector<Index>& tensors) const {
  Panel panel{.title = which,
              .x_label = "n",
              .y_label = "mean |change|",
              .x_log = true};
  for (const Index t : tensors) {
    const std::string& name = names[static_cast<std::size_t>(t)];
    const RunValue change = [t](const Run& run) -> std::optional<double> {
      const auto found = run.stage->arrays.find("weight_change");
      if (found == run.stage->arrays.end() || t >= found->second.rows())
        return {};
      return found->second(t, 0);
    };
    panel.series.push_back(
        over_n(name, "layer " + name.substr(1), jpo::plain("jpo"), change));
  }
  return panel;
}

Figure JpoReport::weight_change() const {
  const auto names = tensor_names(evidence_.experiment);
  std::vector<Index> weights, biases, normalisation;
  for (std::size_t t = 0; t < names.size(); ++t) {
    const char kind = names[t].front();
    auto& list = kind == 'b'                  ? biases
                 : kind == 's' || kind == 'o' ? normalisation
                                              : weights;
    list.push_back(static_cast<Index>(t));
  }
  Figure figure{
      .id = options_.weight_change.id,
      .title = title() + ": change of the JPO network",
      .where = options_.weight_change.where,
      .panels = {tensor_panel("Weights", names, weights),
                 tensor_panel("Biases", names, biases)},
      .note =
          "Mean absolute difference of a tensor's entries before and "
          "after the fit (k: kernels, m: matrices, b: biases, s and o: scales "
          "and offsets of normalisations). Bars: sample standard deviation "
          "over seeds."};
  if (!normalisation.empty()) {
    figure.panels.push_back(
        tensor_panel("Scales and offsets", names, normalisation));
  }
  return figure;
}

}  // namespace physinv
