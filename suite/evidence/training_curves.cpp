#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "suite/evidence/curve.h"
#include "suite/evidence/failures.h"
#include "suite/evidence/guests.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training_report.h"

namespace physinv {
namespace {

/// What one seed's curve shows: a value at each point over three axes.
struct Points {
  std::vector<double> updates, seconds, paper, value;
};

using Axis = std::vector<double> Points::*;

/// One row of an array along the stages, each behind the one before.
Points points_of(std::span<const StageRecord> stages,
                 ArrayKey array,
                 Index row,
                 double paper_update) {
  Points all;
  const auto end = [](const std::vector<double>& v) {
    return v.empty() ? 0.0 : v.back();
  };
  for (const StageRecord& stage : stages) {
    const CurveRow values{stage, array, row};
    const double updates = end(all.updates), seconds = end(all.seconds);
    for (Index k = 0; k < values.points(); ++k) {
      all.updates.push_back(updates + values.updates(k));
      all.seconds.push_back(seconds +
                            stage.curve.seconds[static_cast<std::size_t>(k)]);
      all.paper.push_back(all.updates.back() * paper_update);
      all.value.push_back(values(k));
    }
  }
  return all;
}

/// Median and quantiles over the seeds at each point that all of them have.
Series median_series(const std::vector<Points>& seeds,
                     const MethodLine& line,
                     Axis axis) {
  Series s = series_of(line);
  std::size_t points = seeds.empty() ? 0 : SIZE_MAX;
  for (const Points& p : seeds) points = std::min(points, p.value.size());
  for (std::size_t k = 0; k < points; ++k) {
    std::vector<double> values, x;
    for (const Points& p : seeds) {
      values.push_back(p.value[k]);
      x.push_back((p.*axis)[k]);
    }
    const double middle = median(values);
    // Logarithmic axes have no place for the start, nor for the end of time.
    if (seeds.front().updates[k] <= 0 || !std::isfinite(middle)) continue;
    s.x.push_back(median(x));
    s.y.push_back(middle);
    const double hi = quantile(values, 0.9);
    s.lo.push_back(quantile(values, 0.1));
    s.hi.push_back(std::isfinite(hi) ? hi : middle);
  }
  return s;
}

/// Mean losses of examples that are answered one by one.
std::vector<Points> means_of(const Evidence& e, const std::string& method) {
  std::vector<Points> seeds;
  for (const Run& run : find_runs(e, {method})) {
    const Curve& curve = run.stage->curve;
    Points all;
    for (Index k = 0; k < curve.points(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      all.updates.push_back(curve.iteration[at]);
      all.seconds.push_back(curve.seconds[at]);
      all.paper.push_back(0);
      all.value.push_back(curve.loss.col(k).mean());
    }
    seeds.push_back(std::move(all));
  }
  return seeds;
}

Panel over(const char* x_label, std::string y_label) {
  return {.x_label = x_label,
          .y_label = std::move(y_label),
          .x_log = true,
          .y_log = true};
}

enum class Stages { last, all };

std::vector<Points> losses_of(const Evidence& e,
                              const MethodLine& line,
                              Stages which) {
  std::vector<Points> seeds;
  for (const CaseRecord* c : trained_chains(e, line.method)) {
    const std::span<const StageRecord> chain = c->stages;
    seeds.push_back(points_of(which == Stages::all ? chain : chain.last(1),
                              "mean_loss",
                              0,
                              line.paper_update.value_or(0)));
  }
  return seeds;
}

bool is_guest(const Evidence& e, const std::string& method) {
  const auto added = guests(e);
  return std::ranges::find(added, method) != added.end();
}

/// A panel for each axis; the paper's clock is known for some lines only.
std::vector<Panel> loss_panels(const Evidence& e,
                               const std::vector<MethodLine>& lines,
                               Stages which) {
  Panel updates = over("updates", "test loss"),
        seconds = over("seconds", "test loss"),
        paper = over("seconds by the paper's clock", "test loss");
  for (const MethodLine& line : lines) {
    auto seeds = losses_of(e, line, which);
    if (seeds.empty() && is_guest(e, line.method))
      seeds = means_of(e, line.method);
    if (seeds.empty()) continue;
    updates.series.push_back(median_series(seeds, line, &Points::updates));
    seconds.series.push_back(median_series(seeds, line, &Points::seconds));
    if (line.paper_update)
      paper.series.push_back(median_series(seeds, line, &Points::paper));
  }
  std::vector<Panel> panels = {std::move(updates), std::move(seconds)};
  if (!paper.series.empty()) panels.push_back(std::move(paper));
  return panels;
}

/// " Not drawn: Adam 1 of 3 runs failed." Empty if none did.
std::string failed_note(const Evidence& e,
                        const std::vector<MethodLine>& lines) {
  std::string text;
  for (const MethodLine& line : lines)
    if (const auto failed = failed_text(e, {line.method}); !failed.empty())
      text +=
          (text.empty() ? " Not drawn: " : ", ") + line.label + " " + failed;
  return text.empty() ? "" : text + ".";
}

Figure loss_figure(std::vector<Panel> panels,
                   std::string id,
                   std::string title,
                   std::string where,
                   const std::string& failed) {
  return {.id = std::move(id),
          .title = std::move(title),
          .where = std::move(where),
          .panels = std::move(panels),
          .note =
              "Median over seeds, band: 10 % and 90 % quantiles. Test losses "
              "are not finite where a line ends early." +
              failed};
}

}  // namespace

std::vector<MethodLine> guest_lines(const Evidence& e,
                                    const std::vector<MethodLine>& lines) {
  std::vector<MethodLine> others;
  for (const std::string& method : guests(e))
    if (std::ranges::find(lines, method, &MethodLine::method) == lines.end())
      others.push_back({method, method});
  return others;
}

std::vector<MethodLine> LearningCurves::with_guests(
    std::vector<MethodLine> lines) {
  if (std::exchange(guests_drawn_, true)) return lines;
  const auto others = guest_lines(evidence_, lines);
  lines.insert(lines.end(), others.begin(), others.end());
  return lines;
}

void LearningCurves::losses(const std::vector<MethodLine>& shown,
                            std::string id,
                            std::string title,
                            std::string where) {
  const auto lines = with_guests(shown);
  add(loss_figure(loss_panels(evidence_, lines, Stages::last),
                  std::move(id),
                  std::move(title),
                  std::move(where),
                  failed_note(evidence_, lines)));
}

void LearningCurves::chains(const std::vector<MethodLine>& lines,
                            std::string id,
                            std::string title,
                            std::string where) {
  add(loss_figure(loss_panels(evidence_, lines, Stages::all),
                  std::move(id),
                  std::move(title),
                  std::move(where),
                  failed_note(evidence_, lines)));
}

void LearningCurves::metric(const std::vector<MethodLine>& lines,
                            Index row,
                            std::string y_label,
                            std::string id,
                            std::string title,
                            std::string where) {
  add({.id = std::move(id),
       .title = std::move(title),
       .where = std::move(where),
       .panels = {metric_panel(lines, row, std::move(y_label))},
       .columns = 1,
       .note = "Median over seeds, band: 10 % and 90 % quantiles." +
               failed_note(evidence_, lines)});
}

Panel LearningCurves::panel(const std::vector<MethodLine>& lines) const {
  return loss_panels(evidence_, lines, Stages::last).front();
}

Panel LearningCurves::metric_panel(const std::vector<MethodLine>& lines,
                                   Index row,
                                   std::string y_label) const {
  Panel panel = over("updates", std::move(y_label));
  for (const MethodLine& line : lines) {
    std::vector<Points> seeds;
    for (const auto* s : trained_stages(evidence_, line.method))
      if (s->arrays.contains("metrics"))
        seeds.push_back(points_of({s, 1}, "metrics", row, 0));
    if (!seeds.empty())
      panel.series.push_back(median_series(seeds, line, &Points::updates));
  }
  return panel;
}

void LearningCurves::add(Figure figure) {
  if (!figure.panels.empty() && !figure.panels.front().series.empty())
    section_.figures.push_back(std::move(figure));
}

}  // namespace physinv
