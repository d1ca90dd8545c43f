#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "suite/core/problem.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/curve.h"
#include "suite/evidence/failures.h"
#include "suite/evidence/field_panel.h"
#include "suite/evidence/guests.h"
#include "suite/evidence/options.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training_report.h"

namespace physinv {
namespace {

/// What updates took, and the bytes that stages hold.
struct UpdateCosts {
  void add(const StageRecord& s, TimedStages& timed) {
    if (const auto all = timed.seconds(s))
      seconds.push_back(*all / std::max(1.0, s.curve.iteration.back()));
    bytes.push_back(static_cast<double>(s.buffer_bytes));
  }

  std::vector<double> seconds, bytes;
};

UpdateCosts costs_of(const std::vector<const StageRecord*>& stages,
                     TimedStages& timed) {
  UpdateCosts costs;
  for (const auto* s : stages) costs.add(*s, timed);
  return costs;
}

/// Last stages of its runs, be it a network or a method in Python that answers
/// examples one by one.
std::vector<const StageRecord*> ends_of(const Evidence& e,
                                        const std::string& method) {
  auto stages = trained_stages(e, method);
  const auto added = guests(e);
  if (stages.empty() && std::ranges::find(added, method) != added.end())
    for (const Run& run : find_runs(e, {method}))
      if (run.stage->curve.points() > 0) stages.push_back(run.stage);
  return stages;
}

double end_loss(const StageRecord& s) {
  if (s.stop == Stop::diverged) return kInfinite;
  return s.arrays.contains("mean_loss") ? CurveRow{s}.last() : s.loss.mean();
}

}  // namespace

std::vector<MethodLine> joined(std::vector<MethodLine> a,
                               const std::vector<MethodLine>& b) {
  for (const MethodLine& line : b) {
    const auto same = [&](const auto& l) { return l.method == line.method; };
    if (std::none_of(a.begin(), a.end(), same)) a.push_back(line);
  }
  return a;
}

std::map<std::string, std::string> titles_of(
    const std::vector<MethodLine>& lines) {
  std::map<std::string, std::string> titles;
  for (const MethodLine& line : lines)
    titles.try_emplace(line.method, line.label);
  return titles;
}

Table loss_table(const Evidence& e, const std::vector<MethodLine>& lines) {
  Table table{.id = "results",
              .title = "Test loss at the end, and what an update takes",
              .digits = 5,
              .corner = "method",
              .columns = {"updates",
                          "median loss",
                          "lowest",
                          "highest",
                          "diverged",
                          "CPU ms / update",
                          "MB"}};
  TimedStages timed;
  auto all = lines;
  std::ranges::move(guest_lines(e, lines), std::back_inserter(all));
  for (const MethodLine& line : all) {
    std::vector<double> losses, updates;
    UpdateCosts costs;
    int diverged = 0;
    for (const auto* s : ends_of(e, line.method)) {
      losses.push_back(end_loss(*s));
      updates.push_back(s->curve.iteration.back());
      costs.add(*s, timed);
      diverged += s->stop == Stop::diverged;
    }
    const std::string failed = failed_text(e, {line.method});
    if (!failed.empty())
      table.rows.push_back(
          {.label = line.label,
           .cells = std::vector<Cell>(table.columns.size(), {.text = failed})});
    if (!failed.empty() || losses.empty()) continue;
    const auto [lowest, highest] =
        std::minmax_element(losses.begin(), losses.end());
    table.rows.push_back(
        {.label = line.label,
         .cells = {written(median(updates)),
                   written(median(losses)),
                   written(*lowest),
                   written(*highest),
                   Cell{.ours = diverged,
                        .text = fmt::format("{}/{}", diverged, losses.size())},
                   costs.seconds.empty() ? Cell{.text = kCrowded}
                                         : written(1e3 * median(costs.seconds)),
                   written(1e-6 * median(costs.bytes))}});
  }
  table.note =
      "The loss of a run that diverged is not finite. Memory: buffers the "
      "stage holds. " +
      timed.note();
  return table;
}

namespace {

/// The curve with this label, a new one at the end if there is none.
Series& curve_of(const std::string& label,
                 const MethodLine& line,
                 std::vector<Series>& curves) {
  const auto known =
      std::find_if(curves.begin(), curves.end(), [&](const Series& s) {
        return s.label == label;
      });
  if (known != curves.end()) return *known;
  return curves.emplace_back(Series{.label = label,
                                    .method = label,
                                    .markers = true,
                                    .style = style_of(line)});
}

/// Ascending in x.
void sort_points(Series& series) {
  std::vector<std::pair<double, double>> points;
  for (std::size_t k = 0; k < series.x.size(); ++k)
    points.emplace_back(series.x[k], series.y[k]);
  std::sort(points.begin(), points.end());
  for (std::size_t k = 0; k < points.size(); ++k)
    std::tie(series.x[k], series.y[k]) = points[k];
}

}  // namespace

Figure update_times(const Evidence& e,
                    const std::vector<MethodLine>& lines,
                    std::string where) {
  Panel panel{.x_label = "batch size",
              .y_label = "CPU ms of an update",
              .x_log = true,
              .y_log = true};
  TimedStages timed;
  for (const MethodLine& line : lines) {
    const auto stages = trained_stages(e, line.method);
    const UpdateCosts costs = costs_of(stages, timed);
    const auto batch = stages.empty()
                           ? std::nullopt
                           : number_of(stages.front()->options, "batch");
    if (!batch || costs.seconds.empty()) continue;
    Series& curve = curve_of(
        line.label.substr(0, line.label.find(',')), line, panel.series);
    // The first line of a batch size is the one that was run longest.
    if (std::find(curve.x.begin(), curve.x.end(), *batch) != curve.x.end())
      continue;
    curve.x.push_back(*batch);
    curve.y.push_back(1e3 * median(costs.seconds));
  }
  for (Series& curve : panel.series) sort_points(curve);
  return {.id = "update_times",
          .title = "What an update takes",
          .where = std::move(where),
          .panels = {std::move(panel)},
          .columns = 1,
          .note = timed.note()};
}

std::optional<Answered> answer_of(const Evidence& e,
                                  std::string_view method,
                                  Index example) {
  const auto chains = trained_chains(e, method);
  if (chains.empty()) return {};
  const CaseRecord& c = *chains.front();
  const Batch<double>& x = c.stages.back().x;
  if (x.cols() <= example || c.data.y.cols() <= example ||
      !x.col(example).allFinite())
    return {};
  const auto column = [&](const Batch<double>& all) {
    return all.size() > 0 ? Vector<double>(all.col(example)) : Vector<double>();
  };
  return Answered{
      column(c.data.given), column(c.data.y), column(c.data.x), column(x)};
}

Vector<double> observed(const Problem<double>& problem,
                        const Answered& answer) {
  Batch<double> y(problem.shape().observations, 1);
  Workspace work;
  problem.forward({answer.x, answer.given}, y, work);
  return y;
}

namespace {

/// Colours reach at least as far as in the first panel.
void scale_like_first(std::vector<Panel>& row) {
  if (row.empty()) return;
  share_scale({row.data(), 1});
  for (Panel& panel : row)
    if (panel.field && row.front().field) {
      panel.field->min = row.front().field->min;
      panel.field->max = row.front().field->max;
    }
}

/// Each panel and its observation in turn, those of the truth first; none if
/// it is not answered.
std::vector<Panel> fields_of(const Evidence& e,
                             const std::vector<MethodLine>& lines,
                             const AnsweredFields& drawn,
                             Index example) {
  std::vector<Panel> observed, answers;
  for (const MethodLine& line : lines) {
    const auto answer = answer_of(e, line.method, example);
    if (!answer) continue;
    if (observed.empty()) {
      observed.push_back(drawn.picture("observed y*", answer->wanted));
      answers.push_back(drawn.picture("truth x*", answer->truth));
    }
    observed.push_back(
        drawn.picture(line.label + ", y", drawn.observe(*answer)));
    answers.push_back(drawn.picture(line.label + ", x", answer->x));
  }
  scale_like_first(observed), scale_like_first(answers);
  std::vector<Panel> pairs;
  for (std::size_t k = 0; k < observed.size(); ++k) {
    pairs.push_back(std::move(observed[k]));
    pairs.push_back(std::move(answers[k]));
  }
  return pairs;
}

}  // namespace

std::vector<MethodLine> one_of_each(const Evidence& e,
                                    const std::vector<MethodLine>& lines) {
  std::vector<MethodLine> some;
  std::set<std::string> names;
  for (const MethodLine& line : lines)
    if (answer_of(e, line.method) &&
        names.insert(line.label.substr(0, line.label.find(','))).second)
      some.push_back(line);
  return some;
}

Figure answered_fields(const Evidence& e,
                       const std::vector<MethodLine>& lines,
                       const AnsweredFields& drawn) {
  Figure figure{.id = "fields",
                .title = "What is seen, and what is found",
                .where = drawn.where,
                .columns = 4,
                .picture = true};
  const auto shown = one_of_each(e, lines);
  Index examples = 0;
  for (; examples < drawn.examples; ++examples) {
    auto panels = fields_of(e, shown, drawn, examples);
    if (panels.empty()) break;
    std::move(panels.begin(), panels.end(), std::back_inserter(figure.panels));
  }
  figure.note = fmt::format(
      "The first {} of the test set, in pairs: what is observed and the truth; "
      "then what each method finds, x, and what is observed of it, y. All x "
      "have the scale of the truth, or one that reaches further, and so have "
      "all y. Methods that were run with several settings are shown with "
      "one.",
      examples == 1 ? "example" : fmt::format("{} examples", examples));
  return figure;
}

namespace {

Cell duration_of(const UpdateCosts& costs) {
  if (costs.bytes.empty()) return {.text = kNotRun};
  if (costs.seconds.empty()) return {.text = kCrowded};
  return {.ours = 1e3 * median(costs.seconds)};
}

}  // namespace

Table cost_table(const Evidence& e,
                 const std::vector<CostLine>& lines,
                 std::string where) {
  Table table{.id = "cost",
              .title = "Memory and duration of an update",
              .where = std::move(where),
              .digits = 2,
              .corner = "method",
              .columns = {"MB", "CPU ms / update", "CPU ms / Jacobian"}};
  TimedStages timed;
  for (const CostLine& line : lines) {
    const UpdateCosts costs = costs_of(trained_stages(e, line.method), timed);
    Cell megabytes{.text = kNotRun}, update = duration_of(costs);
    if (!costs.bytes.empty()) megabytes = {.ours = 1e-6 * median(costs.bytes)};
    Cell jacobian{.text = kNothing};
    if (const Select& runs = line.jacobian; !runs.method.empty())
      jacobian = duration_of(
          costs_of(trained_stages(e.of(runs.experiment), runs.method), timed));
    const auto printed = [&](const char* what) {
      return e.published.find(e.experiment, line.published + what);
    };
    if (const auto v = printed("/memory")) megabytes.paper = v->value;
    if (const auto v = printed("/update")) update.paper = 1e3 * v->value;
    if (const auto v = printed("/jacobian")) jacobian.paper = 1e3 * v->value;
    table.rows.push_back(
        {.label = line.label, .cells = {megabytes, update, jacobian}});
  }
  table.note =
      "Ours: bytes of the buffers the stage holds, median over seeds. " +
      timed.note() +
      " The paper's machine had a GPU. Adam's Jacobian is the gradient of its "
      "batch; HIG's here are those of solver and outputs, the network's is "
      "not formed.";
  return table;
}

}  // namespace physinv
