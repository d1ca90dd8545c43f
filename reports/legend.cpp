#include "reports/legend.h"

#include <fmt/format.h>

#include <algorithm>

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
    for (const Series& s : panel.series) {
      if (s.label.empty()) continue;
      const bool known =
          std::any_of(legend.begin(), legend.end(), [&](const Series* k) {
            return same_look(*k, s);
          });
      if (!known) legend.push_back(&s);
    }
  }
  return legend;
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

Palette palette_of(const Figure& figure) {
  Palette palette;
  for (const Panel& p : figure.panels) {
    for (const Series& s : p.series) palette.of(s);
  }
  return palette;
}

void draw_sample(
    Svg& svg, const Series& series, Ink ink, double left, double middle) {
  if (series.line) {
    svg.line(fmt::format("l s{}{}", ink.color, series.dashed ? " d" : ""),
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
