#include "reports/legend.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "reports/panel.h"

namespace physinv {
namespace {

bool same_look(const Series& a, const Series& b) {
  return a.label == b.label && a.method == b.method && a.dashed == b.dashed;
}

}  // namespace

std::vector<const Series*> legend_of(const Figure& figure) {
  std::vector<const Series*> legend;
  for (const Panel& panel : figure.panels) {
    if (!has_points(panel)) continue;
    for (const Series& s : panel.series) {
      if (s.label.empty() || !shows(panel, s)) continue;
      const bool known =
          std::any_of(legend.begin(), legend.end(), [&](const Series* k) {
            return same_look(*k, s);
          });
      if (!known) legend.push_back(&s);
    }
  }
  return legend;
}

std::string undrawn_text(const Figure& figure) {
  const auto drawn = legend_of(figure);
  if (drawn.empty()) return "";
  std::vector<std::string> empty, infinite;
  for (const Panel& panel : figure.panels) {
    for (const Series& s : panel.series) {
      if (s.label.empty() || legend_index(drawn, s) >= 0) continue;
      auto& list = s.y.empty() ? empty : infinite;
      if (std::find(list.begin(), list.end(), s.label) == list.end())
        list.push_back(s.label);
    }
  }
  std::erase_if(infinite, [&](const std::string& label) {
    return std::find(empty.begin(), empty.end(), label) != empty.end();
  });
  std::string text;
  for (const auto& [words, list] :
       {std::pair("not run", &empty), std::pair("no finite number", &infinite)})
    if (!list->empty())
      text += fmt::format(
          "{}{}: {}", text.empty() ? "" : "; ", words, fmt::join(*list, ", "));
  return text;
}

int legend_index(const std::vector<const Series*>& legend,
                 const Series& series) {
  const auto at =
      std::find_if(legend.begin(), legend.end(), [&](const Series* k) {
        return series.label.empty() ? k->method == series.method
                                    : same_look(*k, series);
      });
  return at == legend.end() ? -1 : static_cast<int>(at - legend.begin());
}

DrawnStyle drawn_style(const Series& series, Ink ink) {
  DrawnStyle style{.color = ink.color};
  if (series.markers || !series.line)
    style.marker = 2 * static_cast<int>(ink.marker) + (series.dashed ? 1 : 0);
  if (series.line) style.pattern = 2 * ink.dash + (series.dashed ? 1 : 0);
  return style;
}

namespace {

/// All inks, the nearest to `ink` first: other dashes and markers of its
/// colour, then other colours.
Ink varied(Ink ink, int step) {
  constexpr int kMarkers = static_cast<int>(Marker::cross) + 1;
  constexpr int kColors = static_cast<int>(Hue::indigo) + 1;
  const int dash = step % kDashes, marker = step / kDashes % kMarkers,
            color = step / kDashes / kMarkers;
  return {
      (ink.color + color) % kColors,
      static_cast<Marker>((static_cast<int>(ink.marker) + marker) % kMarkers),
      (ink.dash + dash) % kDashes};
}

constexpr int kVariations = 288;

}  // namespace

Palette palette_of(const Figure& figure, const Palette& report) {
  Palette palette = report;
  std::set<DrawnStyle> taken;
  for (const Series* entry : legend_of(figure)) {
    const Ink usual = palette.of(*entry);
    Ink ink = usual;
    for (int step = 1;
         taken.contains(drawn_style(*entry, ink)) && step < kVariations;
         ++step)
      ink = varied(usual, step);
    taken.insert(drawn_style(*entry, ink));
    palette.set(*entry, ink);
  }
  return palette;
}

void draw_sample(
    Svg& svg, const Series& series, Ink ink, double left, double middle) {
  if (series.line) {
    svg.line(fmt::format("l s{}{}", ink.color, dash_css(ink, series.dashed)),
             left,
             middle,
             left + 28,
             middle);
  }
  if (series.markers || !series.line) {
    draw_marker(svg, ink.marker, left + 14, middle, ink.color, series.dashed);
  }
}

}  // namespace physinv
