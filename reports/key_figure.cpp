#include "reports/key_figure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "reports/legend.h"
#include "reports/marks.h"
#include "reports/panel.h"
#include "reports/plot.h"

namespace physinv {
namespace {

/// How much a panel says of how methods compare.
enum class Rank { nothing, something, curves, learning };

bool is_curve(const Panel& panel, const Series& s) {
  constexpr std::size_t kLeastPoints = 3;
  return !s.label.empty() && s.line && !s.dashed && points(s) >= kLeastPoints &&
         shows(panel, s);
}

Rank rank_of(const Panel& panel) {
  if (!has_points(panel) || constant_of(panel)) return Rank::nothing;
  const auto curves = std::count_if(
      panel.series.begin(), panel.series.end(), [&](const Series& s) {
        return is_curve(panel, s);
      });
  if (panel.field || !panel.y_log || curves < 2) return Rank::something;
  for (const char* word : {"update", "iteration"})
    if (panel.x_label.starts_with(word)) return Rank::learning;
  return panel.x_log ? Rank::curves : Rank::something;
}

std::string text_of(const Figure& figure) {
  const Panel& panel = figure.panels.front();
  std::vector<std::string> labels;
  for (const Series* s : legend_of(figure)) labels.push_back(s->label);
  std::string text = figure.title;
  if (!panel.title.empty()) text += ", " + panel.title;
  if (!panel.x_label.empty() && !panel.y_label.empty())
    text += fmt::format(": {} over {}", panel.y_label, panel.x_label);
  if (!labels.empty()) text += fmt::format("; {}", fmt::join(labels, ", "));
  return text;
}

const Picture& shown_of(const std::vector<Picture>& drawn) {
  const auto curves =
      std::find_if(drawn.begin(), drawn.end(), [](const Picture& p) {
        return p.title.find("curve") != p.title.npos;
      });
  return curves == drawn.end() ? drawn.front() : *curves;
}

/// "JPO" of "JPO: 0.1 off" and of "JPO, x".
bool is_of(const Panel& panel, const std::string& method) {
  return panel.title == method || panel.title.starts_with(method + ":") ||
         panel.title.starts_with(method + ",");
}

/// Of the methods drawn the last panel of the one that ranks best; without
/// ranks the last of all.
const Panel& best_of(const Figure& figure, const Section& section) {
  for (const Table& table : section.tables)
    for (const TableRow& row : table.rows)
      for (auto p = figure.panels.rbegin();
           table.id == "standings" && p != figure.panels.rend();
           ++p)
        if (is_of(*p, row.label)) return *p;
  return figure.panels.back();
}

}  // namespace

std::optional<Figure> key_figure(const Section& section) {
  const Figure* best = nullptr;
  std::size_t at = 0;
  Rank rank = Rank::nothing;
  for (const Figure& figure : section.figures) {
    if (figure.picture) continue;
    for (std::size_t k = 0; k < figure.panels.size(); ++k) {
      const Rank own = rank_of(figure.panels[k]);
      const bool later = &figure == best && own == rank &&
                         own == Rank::learning &&
                         figure.panels[k].x_label == figure.panels[at].x_label;
      if (own <= rank && !later) continue;
      best = &figure, at = k, rank = own;
    }
  }
  if (best == nullptr) return {};
  Figure figure{.id = "card",
                .title = best->title,
                .where = best->where,
                .panels = {best->panels[at]},
                .columns = 1,
                .note = {}};
  return figure;
}

std::optional<Figure> before_and_after(const Section& section) {
  for (const Figure& figure : section.figures) {
    if (!figure.picture) continue;
    for (const char* before : {"start", "truth"}) {
      const auto first = std::ranges::find_if(
          figure.panels,
          [&](const Panel& p) { return p.title.starts_with(before); });
      if (first == figure.panels.end()) continue;
      const Panel& best = best_of(figure, section);
      if (&*first == &best) break;
      return Figure{
          .id = "card-picture",
          .title = fmt::format("{}, then {}", first->title, best.title),
          .panels = {*first, best},
          .columns = 2,
          .picture = true};
    }
  }
  return {};
}

std::optional<std::string> card_svg(const Section& section,
                                    const Palette& palette,
                                    const std::vector<Picture>& drawn) {
  if (const auto figure = key_figure(section))
    return render_card(*figure, palette);
  if (drawn.empty()) return {};
  return shown_of(drawn).svg;
}

std::optional<std::string> card_text(const Section& section,
                                     const std::vector<Picture>& drawn) {
  if (const auto figure = key_figure(section)) return text_of(*figure);
  if (drawn.empty()) return {};
  return shown_of(drawn).title;
}

}  // namespace physinv
