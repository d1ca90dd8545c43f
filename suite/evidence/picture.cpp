#include "suite/evidence/picture.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "suite/core/math.h"
#include "suite/evidence/field_panel.h"
#include "suite/results/results.h"

namespace physinv {
namespace {

bool has_unknowns(const Run& run, Index example = 0) {
  return run.stage->x.cols() > example && run.record->data.y.cols() > example &&
         run.stage->x.col(example).allFinite();
}

/// A column; no entries where there is none.
Vector<double> column(const Batch<double>& all, Index k) {
  return all.cols() > k ? Vector<double>(all.col(k)) : Vector<double>();
}

/// The first run of the first method whose unknowns are stored.
std::optional<Run> first_stored(const Evidence& e,
                                const std::vector<PicturedMethod>& methods) {
  for (const PicturedMethod& m : methods)
    if (const auto run = first_run(e, m.runs); run && has_unknowns(*run))
      return run;
  return {};
}

}  // namespace

std::optional<Pictured> pictured(const Evidence& e,
                                 const std::vector<PicturedMethod>& methods,
                                 const Vector<double>& start,
                                 const WorthShowing& worth) {
  const auto first = first_stored(e, methods);
  if (!first) return {};
  const CaseData& data = first->record->data;
  Pictured shown{.examples = data.y.cols(), .seed = first->seed()};
  for (Index k = 0; worth.holds && k < shown.examples; ++k) {
    if (!worth.holds(column(data.given, k), column(data.y, k))) continue;
    if (shown.alike++ == 0) shown.example = k;
  }
  const Index k = shown.example;
  shown.given = column(data.given, k);
  shown.y = column(data.y, k);
  if (data.x.rows() > 0 && data.x.cols() > k)
    shown.found.push_back({"truth", column(data.x, k)});
  if (start.size() > 0) shown.found.push_back({"start", start});
  for (const PicturedMethod& m : methods)
    for (const Run& run : find_runs(e, m.runs)) {
      if (run.record->data.hash != data.hash || !has_unknowns(run, k)) continue;
      shown.found.push_back({m.who, column(run.stage->x, k)});
      break;
    }
  return shown;
}

Figure picture(const PictureOptions& options,
               const std::optional<Pictured>& shown) {
  Figure figure{
      .id = "picture", .title = options.title, .columns = 3, .picture = true};
  if (!shown) {
    figure.note =
        "Nothing is drawn: the unknowns that were found are not stored with "
        "these results.";
    return figure;
  }
  for (const FoundBy& found : shown->found)
    figure.panels.push_back(options.draw(found, *shown));
  share_scale(figure.panels);
  figure.note =
      fmt::format("Problem {} of {}, seed {}{}. {}",
                  shown->example + 1,
                  shown->examples,
                  shown->seed,
                  shown->alike == 0 ? ""
                                    : fmt::format(", the first of {} {}",
                                                  shown->alike,
                                                  options.worth.says),
                  options.note);
  return figure;
}

double few_digits(double value) { return std::round(1e4 * value) / 1e4; }

Series circle(std::string label,
              std::string method,
              double x,
              double y,
              double radius,
              PlotStyle style) {
  constexpr int kSides = 32;
  Series s{.label = std::move(label), .method = std::move(method)};
  for (int k = 0; k <= kSides; ++k) {
    const double angle = 2 * std::numbers::pi * k / kSides;
    s.x.push_back(few_digits(x + radius * math::cos(angle)));
    s.y.push_back(few_digits(y + radius * math::sin(angle)));
  }
  s.style = style;
  return s;
}

}  // namespace physinv
