#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "problems/heat/heat.h"
#include "suite/cases/sip/heat/grids.h"
#include "suite/cases/sip/heat/metrics.h"
#include "suite/evidence/cell.h"
#include "suite/evidence/curve.h"
#include "suite/evidence/field_panel.h"
#include "suite/evidence/series.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training_report.h"
#include "suite/harness/registry.h"

namespace physinv::heat {
namespace {

const std::vector<MethodLine> kDirect = {
    {"gd", "gradient descent", Hue::blue},
    {"lbfgsb", "L-BFGS-B", Hue::green},
    {"inverse-physics", "inverse physics", Hue::red}};

/// A method's longest training comes first.
std::vector<MethodLine> networks() {
  std::vector<MethodLine> all = {{"sgd", "SGD", Hue::brown},
                                 {"adahessian", "AdaHessian", Hue::teal},
                                 {"hf", "Hessian-free", Hue::grey}};
  for (const char* size : {"", "-b32", "-b8", "-b4"}) {
    const std::string tail = size;
    const std::string batch = tail.empty() ? "" : ", batch " + tail.substr(2);
    all.push_back({"sip" + tail, "SIP" + batch, Hue::orange});
    all.push_back({"adam" + tail, "Adam" + batch, Hue::purple});
  }
  all.push_back({"hf-b4", "Hessian-free, batch 4", Hue::grey});
  all.push_back({"sgd-b4", "SGD, batch 4", Hue::brown});
  all.push_back({"sgd-b8-lr3", "SGD 1e-3, batch 8", Hue::olive});
  return all;
}

std::vector<double> ends(const Evidence& e,
                         const std::string& method,
                         MetricRow row) {
  std::vector<double> all;
  for (const StageRecord* s : trained_stages(e, method))
    all.push_back(CurveRow{*s, "metrics", row}.last());
  return all;
}

std::optional<double> end(const Evidence& e,
                          const std::string& method,
                          MetricRow row) {
  const auto all = ends(e, method, row);
  return all.empty() ? std::nullopt : std::optional(median(all));
}

Table errors(const Evidence& e) {
  Table table{
      .id = "errors",
      .title = "Errors at the end, sums of |x - x*| over the cells",
      .where = "Fig. 13",
      .corner = "method",
      .columns = {"sum |x - x*|",
                  "clamped at 0",
                  "share left, coarse",
                  "share left, fine"},
      .note =
          "Means over the examples and, with their deviation, over the seeds. "
          "Coarse waves "
          "are those damped to 1/e at most, fine ones those damped to e^-4 "
          "and further, to e^-16; shares are of x*'s energy. The paper's "
          "script clamps networks only."};
  const auto add = [&](const MethodLine& line) {
    if (!end(e, line.method, kError)) return;
    std::vector<Cell> cells;
    for (const MetricRow row : {kError, kClamped, kCoarse, kFine})
      cells.push_back(row <= kClamped ? cell_of(ends(e, line.method, row))
                                      : written(end(e, line.method, row)));
    if (const auto paper = e.published.find(kName, "fig13/" + line.method))
      cells[kClamped].paper = paper->value;
    table.rows.push_back({.label = line.label, .cells = std::move(cells)});
  };
  for (const auto& lines : {networks(), kDirect})
    for (const MethodLine& line : lines) add(line);
  if (table.rows.empty()) return table;
  for (const auto& [row, label] :
       {std::pair(kOfMean, "mean of y"), std::pair(kOfObserved, "y itself")})
    for (const char* any : {"gd", "sip", "sip-b8", "sip-b4"})
      if (const auto error = end(e, any, row)) {
        table.rows.push_back({.label = label,
                              .cells = {cell_of(error),
                                        Cell{.text = kNothing},
                                        Cell{.text = kNothing},
                                        Cell{.text = kNothing}}});
        break;
      }
  return table;
}

/// Fig. 13: what single examples reach, and what networks answer at once.
Figure direct(const Evidence& e) {
  Panel panel{.x_label = "iterations",
              .y_label = "sum |x - x*|",
              .x_log = true,
              .y_min = 0};
  for (const MethodLine& line : kDirect) {
    const auto stages = trained_stages(e, line.method);
    if (stages.empty()) continue;
    const CurveRow row{*stages.front(), "metrics", kError};
    Series s = series_of(line);
    for (Index k = 0; k < row.points(); ++k)
      if (row.updates(k) > 0)
        s.x.push_back(row.updates(k)), s.y.push_back(row(k));
    panel.series.push_back(std::move(s));
  }
  if (panel.series.empty()) return {.id = "fig13"};
  double last = 1;
  for (const Series& s : panel.series)
    if (!s.x.empty()) last = std::max(last, s.x.back());
  for (const MethodLine& line : networks())
    if (const auto error = end(e, line.method, kClamped);
        error && line.label.find("1e-3") == std::string::npos)
      panel.series.push_back(
          level(line.label, line.method, 1, last, *error, style_of(line)));
  return {.id = "fig13",
          .title = "Examples by themselves",
          .where = "Fig. 13",
          .panels = {std::move(panel)},
          .columns = 1,
          .note =
              "Dashed: networks at the end of their training, clamped at "
              "zero as in the paper. Means over the same test examples."};
}

/// Row by row, from below.
Panel picture(std::string title, const Vector<double>& field) {
  const auto side = static_cast<Index>(std::lround(std::sqrt(field.size())));
  return field_panel(std::move(title), {side, side, 1, side}, field);
}

Figure pictures(const Evidence& e) {
  auto lines = networks();
  std::erase_if(lines, [](const auto& l) { return l.method == "sgd-b8-lr3"; });
  const auto physics = problems::heat({.resolution = kSide}).make<double>();
  return answered_fields(
      e,
      joined(lines, kDirect),
      {.where = "Fig. 10",
       .picture = picture,
       .observe = [&](const Answered& a) { return observed(*physics, a); }});
}

constexpr const char* kByRate = "Error by rate and batch";
constexpr const char* kBySet = "Error by size of the training set";

std::string setting_of(const GridPoint& cell) {
  return cell.set > 0
             ? fmt::format("{} examples, batch {}", cell.set, cell.batch)
             : fmt::format("rate 1e-{}, batch {}", cell.decade, cell.batch);
}

/// Figs. 11 and 12: SIP and Adam in every cell.
Table study(const Evidence& e,
            std::string id,
            std::string title,
            std::string where,
            const std::vector<GridPoint>& points) {
  Table table{.id = std::move(id),
              .title = std::move(title),
              .where = std::move(where),
              .corner = "setting",
              .columns = {"SIP", "Adam"},
              .across = Across{.key = "method", .quantities = {"error"}}};
  for (const GridPoint& cell : points) {
    if (cell.id("") == "") continue;  // has its own length
    const auto sip = end(e, cell.id("sip"), kError),
               adam = end(e, cell.id("adam"), kError);
    if (!sip && !adam) continue;
    table.rows.push_back(
        {.label = setting_of(cell), .cells = {cell_of(sip), cell_of(adam)}});
  }
  return table;
}

/// The same along the way, a panel for each setting.
Figure study_curves(const LearningCurves& curves,
                    std::string id,
                    std::string title,
                    std::string where,
                    const std::vector<GridPoint>& points) {
  Figure figure{.id = std::move(id),
                .title = std::move(title),
                .where = std::move(where),
                .columns = 3,
                .note =
                    "On the test set; median over seeds, band: 10 % and "
                    "90 % quantiles. The paper's are means over 64 "
                    "updates, and of finite sets also on the training "
                    "set, whose errors are not recorded."};
  for (const GridPoint& cell : points) {
    Panel panel = curves.metric_panel(
        {{cell.id("sip"), "SIP", Hue::orange, {}, "sip"},
         {cell.id("adam"), "Adam", Hue::purple, {}, "adam"}},
        kError,
        "sum |x - x*|");
    if (panel.series.empty()) continue;
    panel.title = setting_of(cell);
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Section report(const Evidence& e) {
  Section section{
      .tables = {errors(e),
                 loss_table(e, networks()),
                 study(e, "fig11", kByRate, "Fig. 11", rate_points()),
                 study(e, "fig12", kBySet, "Fig. 12", set_points())},
      .method_titles = titles_of(joined(networks(), kDirect))};
  std::erase_if(section.tables, [](const Table& t) { return t.rows.empty(); });
  LearningCurves curves(e, section);
  curves.metric(
      networks(), kError, "sum |x - x*|", "fig10", "Errors of x", "Fig. 10");
  curves.losses(networks(), "losses", "Losses of y", "");
  curves.add(
      study_curves(curves, "fig11_curves", kByRate, "Fig. 11", rate_points()));
  curves.add(
      study_curves(curves, "fig12_curves", kBySet, "Fig. 12", set_points()));
  curves.add(update_times(e, networks(), "Fig. 15"));
  for (Figure figure : {direct(e), pictures(e)})
    if (!figure.panels.empty()) section.figures.push_back(std::move(figure));
  return section;
}

Section operator_page(const Evidence& e) {
  const std::vector<MethodLine> lines = {
      {"fno", "FNO", Hue::pink},
      {"fno-lr4", "FNO, rate 1e-4", Hue::red},
      {"fno-b8", "FNO, batch 8", Hue::pink},
      {"fno-b8-lr4", "FNO, batch 8, rate 1e-4", Hue::red},
      {"fno-long-b8-lr2", "FNO, batch 8, rate 1e-2, longer", Hue::brown},
      {"fno-long-b8", "FNO, batch 8, longer", Hue::pink},
      {"fno-long-b8-lr4", "FNO, batch 8, rate 1e-4, longer", Hue::red}};
  Section section{.tables = {loss_table(e, lines)},
                  .method_titles = titles_of(lines)};
  LearningCurves curves(e, section);
  curves.metric(
      lines, kError, "sum |x - x*|", "fig10", "Errors of x", "Fig. 10");
  curves.losses(lines, "losses", "Losses of y", "");
  return section;
}

}  // namespace

void add_reports(Registry& r) {
  r.add_report(kName, report);
  r.add_report(kOperator, operator_page);
}

}  // namespace physinv::heat
